// The record of a run: one folder with one SQLite file. What is committed stays, whatever happens to the process.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "input_error.hpp"
#include "maker.hpp"
#include "population.hpp"
#include "verification.hpp"

namespace evodevo {

/// A folder that cannot be written, read, or is in use. what() names folder, cause and remedy.
struct ArchiveError : InputError {
  using InputError::InputError;
};

/// An individual with the generation in which it was dropped.
struct ArchivedIndividual : Individual {
  std::optional<std::uint32_t> died;
};

/// Individuals that have no fitness, and why.
struct Failure {
  std::string status;
  std::string reason;  ///< of the first of them
  std::int64_t count = 0;
  bool varies = false;  ///< whether others have other numbers in it
};

/// A run's file in its folder.
inline constexpr const char* database_name = "run.sqlite";

class Archive {
 public:
  /// Starts the record of a run in a new folder; this program on `device` is its first maker. Throws ArchiveError if
  /// the folder is there and not empty.
  static Archive create(const std::filesystem::path& folder, const Experiment& experiment, const std::string& device);
  /// Opens a record to go on with it; refuses while another process writes it.
  static Archive resume(const std::filesystem::path& folder);
  /// Opens a record to add what is found out about its individuals. Does not disturb a process that writes it.
  static Archive annotate(const std::filesystem::path& folder);
  /// Opens a record to read: all that it says is of the moment at which it is first asked. Does not disturb a process
  /// that writes it.
  static Archive read(const std::filesystem::path& folder);

  Archive(Archive&&) noexcept;
  ~Archive();

  /// Adds one generation in one transaction: its newborns with their results, who was dropped, records of lives by id,
  /// and its summary. An empty record is kept too: it says that the individual was on the front and nothing changed.
  void commit(const std::vector<Individual>& newborns, const std::vector<std::uint32_t>& dropped,
              const std::map<std::uint32_t, LifeRecord>& lives, const Summary& summary);

  /// Adds verifications; they take the place of earlier ones of the same individuals.
  void add_verifications(const std::vector<Verification>& verifications);

  const std::filesystem::path& folder() const { return folder_; }
  /// An entry of the run's record, such as "seed" or "created". Throws ArchiveError if there is none.
  std::string record(const std::string& key) const;
  /// The same; nothing if there is none.
  std::optional<std::string> find_record(const std::string& key) const;
  void set_record(const std::string& key, const std::string& value);
  /// The same for several entries, all of them or none.
  void set_records(const std::map<std::string, std::string>& entries);
  /// The place among the makers of the one given, which is added if it is none of them yet.
  std::uint32_t add_maker(const Maker& maker);
  /// All who made generations or were about to, in the order in which they came.
  std::vector<Maker> makers() const;
  /// Who made a generation.
  Maker maker(std::uint32_t generation) const;
  std::vector<Objective> objectives() const;
  std::vector<Summary> generations() const;
  /// What individuals failed of, the most frequent first; reasons that differ from the first number on are one.
  std::vector<Failure> failures() const;
  /// Number of individuals by status.
  std::map<std::string, std::int64_t> statuses() const;
  /// Those who live on, in the order of birth.
  std::vector<Individual> population() const;
  std::optional<ArchivedIndividual> individual(std::uint32_t id) const;
  /// The ids of the `count` individuals with the best first objective, best first; ties in the order of birth.
  std::vector<std::uint32_t> best(std::size_t count) const;
  /// What development did to an individual; nothing where it never reached the front.
  std::optional<LifeRecord> life(std::uint32_t id) const;
  /// Of an individual; nothing where it was not verified.
  std::optional<Verification> verification(std::uint32_t id) const;

 private:
  struct Files;
  Archive(std::filesystem::path folder, std::unique_ptr<Files> files);
  /// Opens the database with SQLite's `flags` and checks that it is a run that this program reads.
  static Archive opened(const std::filesystem::path& folder, int flags);
  void insert_maker(std::uint32_t place, const Maker& maker);

  std::filesystem::path folder_;
  std::unique_ptr<Files> files_;
};

/// The experiment that a run used, read from its record. Operators are looked for on `plugin_path` too.
Experiment recorded_experiment(const Archive& archive, std::vector<std::filesystem::path> plugin_path = {});

}  // namespace evodevo
