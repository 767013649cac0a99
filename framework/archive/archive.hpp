// The archive of a run: one SQLite file in the folder of the run. Committed data remain even if the process is killed.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "archive/error.hpp"
#include "archive/journal.hpp"
#include "archive/population.hpp"
#include "archive/provenance.hpp"
#include "life/verification/verification.hpp"

namespace evodevo {

class RunDatabase;

/// The folders of the islands of a run, in the folder of the run, have this name and a number from 1.
inline constexpr const char* island_folder_prefix = "island-";
/// Returns whether a folder holds folders of islands, and so no archive itself.
bool has_islands(const std::filesystem::path& folder);
/// Returns whether a folder holds an archive to which something was committed. It does not if a process ended while it
/// created the archive.
bool is_begun(const std::filesystem::path& folder);
/// Makes the folder of a new run. Throws ArchiveError if it exists and has anything in it, except what is left of an
/// archive that was not begun.
void begin_run_folder(const std::filesystem::path& folder);

/// Records of lives of one individual, which follow each other.
struct RecordedLives {
  std::uint32_t first = 1;  ///< number of the first of them
  std::vector<LifeRecord> records;
};
using LivesById = std::map<std::uint32_t, RecordedLives>;

/// What a generation adds to the archive.
struct FinishedGeneration {
  std::vector<Individual> newborns;        ///< with their results
  std::vector<Individual> measured_again;  ///< members of the population that have lived again, with all scores
  std::vector<std::uint32_t> dropped;      ///< ids of those that selection dropped
  LivesById lives;                         ///< of individuals on the front, as far as they are new
  Summary summary;
  Remembered remembered;                ///< of the selection operators
  std::vector<Refusal> refusals;        ///< of newborns or older ones
  std::vector<Emigration> emigrations;  ///< after the generation
};

/// An individual with the generation in which it was dropped.
struct ArchivedIndividual : Individual {
  std::optional<std::uint32_t> died;
};

/// A score of an individual in one repeat of one scenario.
struct ArchivedTest {
  std::uint32_t life = 1;  ///< number of the life, from 1
  std::string scenario;
  std::int64_t repeat = 0;  ///< from 0
  std::string objective;
  double value = 0;
};

/// A kind of score that is not an objective.
struct MeasureKind {
  std::string name, unit, role;
};

/// An individual without failure, its first objective and the values of some descriptors.
struct Described {
  std::uint32_t id = 0, born = 0;
  double score = 0;
  std::vector<double> descriptors;
};

/// A score of an individual that is not an objective.
struct ArchivedMeasure : MeasureKind {
  double value = 0;
};

/// A score of an objective, and the generations in which its individual was in the population.
struct Membership {
  std::uint32_t born = 0;             ///< first generation
  std::optional<std::uint32_t> died;  ///< generation whose selection dropped it
  double value = 0;
};

/// A number that the selection operator has noted about an individual.
struct ArchivedNote {
  std::string name, unit;
  double value = 0;
};

/// An individual that came from another island of the run.
struct Immigrant {
  std::uint32_t id = 0, born = 0;
  std::optional<std::uint32_t> died;
  Migrated from;
};

/// The numbers with one title that the selection operator has noted about the living, generation by generation.
struct NoteHistory {
  NoteTitle title;
  std::vector<std::vector<double>> living;  ///< for each generation, the notes about those who survived its selection
};

/// A group of individuals that have no fitness for the same reason.
struct Failure {
  std::string status;
  std::string reason;  ///< reason of the first individual in the group
  std::int64_t count = 0;
  bool varies = false;  ///< whether the reasons of other individuals in the group differ from it after the first digit
};

/// A number of what selection sees, as `evodevo signal` measures it.
struct SignalNumber {
  std::string population;  ///< whose: "random", "last" or "champion"
  std::string quantity;    ///< such as "repeatability"
  std::string of;          ///< of what, such as "one life"
  std::string scale;       ///< "rank", "share", or "value": by value, and of scores in the unit of the first objective
  double value = 0;
  std::optional<double> low, high;  ///< 95 % interval
  std::int64_t count = 0;           ///< number of robots, children or lives that were measured
};

/// The archive of a run. Functions that read it check every value; they throw ArchiveError if a value is impossible.
class Archive {
 public:
  /// Starts the archive of a new run. The first provenance is that of this program on `device`. Throws ArchiveError if
  /// begin_run_folder() does. `journal` applies to the whole run; by default, it depends on the folder's
  /// file system.
  static Archive create(const std::filesystem::path& folder, const Experiment& experiment, const std::string& device,
                        std::optional<Journal> journal = std::nullopt);
  /// Opens an archive to continue its run. Throws ArchiveError if another process is continuing the run.
  static Archive resume(const std::filesystem::path& folder, std::optional<Journal> journal = std::nullopt);
  /// Opens an archive to add findings about its individuals, such as verifications. Another process may continue the
  /// run at the same time.
  static Archive annotate(const std::filesystem::path& folder);
  /// Opens an archive for reading. All functions return its content as of the first read, even if another process
  /// continues the run at the same time.
  static Archive read(const std::filesystem::path& folder);

  Archive(Archive&&) noexcept;
  ~Archive();

  /// Adds one generation in one transaction. An empty record of a life is stored too; it means that the individual was
  /// on the front and that its body did not change. What the selection operator remembers replaces that of the
  /// generation before; a note is added if it differs from the last one about the same individual. The refused get the
  /// status and the reason of the refusal, and lose their scores.
  void commit(const FinishedGeneration& generation);

  /// Adds verifications. They replace earlier verifications of the same individuals. Leaves out those of individuals
  /// that have lost their fitness, or have another, since they were chosen.
  void add_verifications(const std::vector<Verification>& verifications);

  /// Stores what was measured of the run, in place of earlier numbers. Returns false and stores nothing if `generation`
  /// is no longer the last.
  bool set_signal(const std::vector<SignalNumber>& numbers, std::uint32_t generation);

  const std::filesystem::path& folder() const;
  /// Returns whether the run's file is still the one that was opened; if it is not, written data are lost.
  bool is_in_place() const;
  /// Throws an ArchiveError which says that the record of the run is inconsistent. `what` describes how.
  [[noreturn]] void refuse(const std::string& what) const;
  /// Returns an entry of the run's record, such as "seed" or "created". Throws ArchiveError if there is none.
  std::string record(const std::string& key) const;
  /// Returns an entry of the run's record, or nullopt if there is none.
  std::optional<std::string> find_record(const std::string& key) const;
  /// Returns an entry of the run's record that holds a time, s, or nullopt if there is none.
  std::optional<double> find_seconds(const std::string& key) const;
  /// Sets an entry of the run's record.
  void set_record(const std::string& key, const std::string& value);
  /// Sets several entries of the run's record in one transaction.
  void set_records(const std::map<std::string, std::string>& entries);
  /// Adds a provenance to those of the run, unless the run has it already, and returns its index.
  std::uint32_t add_provenance(const Provenance& provenance);
  /// Returns the number of the island, from 1, of whose generations this is the archive; 0 if the run has no islands.
  std::int64_t island() const;
  /// Returns who came from other islands, in the order of birth.
  std::vector<Immigrant> immigrants() const;
  /// Returns who emigrated to an island after generation `since` or later, by generation, in the order of their ids.
  std::map<std::uint32_t, std::vector<std::uint32_t>> emigrants_to(std::int64_t island, std::uint32_t since) const;
  /// Returns the provenances of all processes that took part in the run, in the order in which they were added. They
  /// include the provenances of processes that ended before a generation was complete.
  std::vector<Provenance> provenances() const;
  /// Returns the number of individuals with each of provenances().
  std::vector<std::int64_t> evaluated_by_provenance() const;
  std::vector<Objective> objectives() const;
  /// Returns the contents of the files that parameters of operators name.
  FileContents files() const;
  /// Returns the layout of whole genomes.
  const Layout& layout() const;
  std::vector<Summary> generations() const;
  /// Returns the reasons why individuals failed, most frequent first. Reasons that agree up to the first digit are one
  /// group.
  std::vector<Failure> failures() const;
  /// Returns the number of individuals with each status.
  std::map<std::string, std::int64_t> statuses() const;
  /// Returns the individuals that are alive after the last generation, in the order of birth, with all their scores.
  std::vector<Individual> population() const;
  /// Returns an individual, or nullopt if there is none with this id.
  std::optional<ArchivedIndividual> individual(std::uint32_t id) const;
  /// Returns an individual to which the archive itself refers. Throws ArchiveError if there is none with this id.
  ArchivedIndividual known_individual(std::uint32_t id) const;
  /// Returns the ids of the `count` individuals with the best score in an objective, given by its index, best first;
  /// ties are in the order of birth.
  std::vector<std::uint32_t> best(std::size_t count, std::size_t objective = 0) const;
  /// Returns the scores in an objective, given by its index, of all individuals that survived the selection of at least
  /// one generation, in the order of birth.
  std::vector<Membership> memberships(std::size_t objective) const;
  /// Returns the kinds of scores that are not objectives, in the order of the experiment.
  std::vector<MeasureKind> measures() const;
  /// Returns the scores of an individual that are not objectives, in the order of the experiment.
  std::vector<ArchivedMeasure> measures(std::uint32_t id) const;
  /// Returns the descriptors of the experiment with their ranges and bins.
  std::vector<Objective> descriptors() const;
  /// Returns the individuals without failure, in the order of birth, each with the values of the first `count` of
  /// descriptors().
  std::vector<Described> described(std::size_t count) const;
  /// Returns what numbers the selection operator may note.
  std::vector<NoteTitle> note_titles() const;
  /// Returns the last numbers that the selection operator has noted about an individual, in the order of note_titles().
  std::vector<ArchivedNote> notes(std::uint32_t id) const;
  /// Returns what the selection operator had noted about the living after each generation, for each of note_titles().
  std::vector<NoteHistory> note_histories() const;
  /// Returns what the selection operators remember after the last generation.
  Memories memory() const;
  /// Returns the scores of an individual in each repeat of each scenario, life by life, in the order of the experiment.
  std::vector<ArchivedTest> tests(std::uint32_t id) const;
  /// Returns the records of an individual's lives; none if the individual never reached the front.
  std::vector<LifeRecord> lives(std::uint32_t id) const;
  /// Returns the verification of an individual, or nullopt if the individual has not been verified.
  std::optional<Verification> verification(std::uint32_t id) const;
  /// Returns what was measured of the run; empty if nothing was.
  std::vector<SignalNumber> signal() const;

 private:
  explicit Archive(std::unique_ptr<RunDatabase> run);
  void insert_provenance(std::uint32_t position, const Provenance& provenance);
  void insert_record(const std::string& key, const std::string& value);

  std::unique_ptr<RunDatabase> run_;
  mutable std::optional<Layout> layout_;  ///< read when it is first needed
};

}  // namespace evodevo
