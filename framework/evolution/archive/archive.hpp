// The record of a run: one folder with one SQLite file. What is committed stays, whatever happens to the process.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "evolution/archive/error.hpp"
#include "evolution/archive/journal.hpp"
#include "evolution/population.hpp"
#include "evolution/provenance.hpp"
#include "life/verification.hpp"

namespace evodevo {

class RunDatabase;

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

/// What it is asked for it checks as input: whatever cannot be is thrown as ArchiveError.
class Archive {
 public:
  /// Starts the record of a run in a new folder; this program on `device` is its first provenance. Throws ArchiveError
  /// if the folder is there and not empty. A wish for a journal holds for the whole run; without one, the folder's file
  /// system decides.
  static Archive create(const std::filesystem::path& folder, const Experiment& experiment, const std::string& device,
                        std::optional<Journal> journal = std::nullopt);
  /// Opens a record to go on with it; refuses while another process writes it.
  static Archive resume(const std::filesystem::path& folder, std::optional<Journal> journal = std::nullopt);
  /// Opens a record to add what is found out about its individuals. Does not disturb a process that writes it.
  static Archive annotate(const std::filesystem::path& folder);
  /// Opens a record to read: all that it says is as of the first question. Does not disturb a process
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

  const std::filesystem::path& folder() const;
  /// Whether the run's file is still the one that was opened; if it is not, what is written is lost.
  bool is_in_place() const;
  /// Throws ArchiveError: `what` cannot be in the record of a run.
  [[noreturn]] void refuse(const std::string& what) const;
  /// An entry of the run's record, such as "seed" or "created". Throws ArchiveError if there is none.
  std::string record(const std::string& key) const;
  /// The same; nothing if there is none.
  std::optional<std::string> find_record(const std::string& key) const;
  /// The same of a time, s.
  std::optional<double> find_seconds(const std::string& key) const;
  void set_record(const std::string& key, const std::string& value);
  /// The same for several entries, all of them or none.
  void set_records(const std::map<std::string, std::string>& entries);
  /// The index of a provenance among those of the run, to which it is added if it is not among them yet.
  std::uint32_t add_provenance(const Provenance& provenance);
  /// The provenances of all generations, and of those that were about to be made, in the order in which they came.
  std::vector<Provenance> provenances() const;
  /// The provenance of a generation.
  Provenance provenance(std::uint32_t generation) const;
  std::vector<Objective> objectives() const;
  std::vector<Summary> generations() const;
  /// What individuals failed of, the most frequent first; reasons that differ from the first number on are one.
  std::vector<Failure> failures() const;
  /// Number of individuals by status.
  std::map<std::string, std::int64_t> statuses() const;
  /// Those who live on, in the order of birth.
  std::vector<Individual> population() const;
  std::optional<ArchivedIndividual> individual(std::uint32_t id) const;
  /// One that the record itself names.
  ArchivedIndividual known_individual(std::uint32_t id) const;
  /// The ids of the `count` individuals with the best first objective, best first; ties in the order of birth.
  std::vector<std::uint32_t> best(std::size_t count) const;
  /// What development did to an individual; nothing where it never reached the front.
  std::optional<LifeRecord> life(std::uint32_t id) const;
  /// Of an individual; nothing where it was not verified.
  std::optional<Verification> verification(std::uint32_t id) const;

 private:
  explicit Archive(std::unique_ptr<RunDatabase> run);
  void insert_provenance(std::uint32_t position, const Provenance& provenance);
  void insert_record(const std::string& key, const std::string& value);

  std::unique_ptr<RunDatabase> run_;
};

/// The settings that a run used, read from its record; no operator is looked for.
Settings recorded_settings(const Archive& archive);

/// The experiment that a run used, read from its record. Operators are looked for on `plugin_path` too.
Experiment recorded_experiment(const Archive& archive, std::vector<std::filesystem::path> plugin_path = {});

}  // namespace evodevo
