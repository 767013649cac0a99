// An experiment: its settings and the operators that its TOML file names.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/genome_sections.hpp"
#include "evodevo/plugin.hpp"
#include "experiment/overrides.hpp"
#include "experiment/settings.hpp"
#include "experiment/toml_reader.hpp"
#include "operators/operator_use.hpp"

namespace evodevo {

/// A variation operator and the probability that it is applied to a child.
template <class T>
struct Varied {
  std::unique_ptr<T> op;
  std::string name;
  double probability = 0.5;
  SectionIndices sections = {};                ///< on which it works
  Layout layout = {};                          ///< of these sections
  std::optional<std::uint32_t> own_section{};  ///< the section that it owns, one of `sections`
};

/// A devo operator and the schedule of its applications.
struct Scheduled {
  std::unique_ptr<Devo> op;
  std::string label;  ///< its own name; with a number if an earlier operator has the same
  Schedule schedule;
  std::optional<std::uint32_t> own_section{};  ///< the section that it owns
};

/// A fitness operator, and how its scores in several tests become one.
struct Scored {
  std::unique_ptr<Fitness> op;
  Over over = Over::mean;
  std::optional<std::size_t> scenario{};  ///< index of the only scenario whose tests count; if not given, all count
};

struct Experiment : Settings {
  Experiment() = default;
  Experiment(Experiment&&) = default;
  Experiment& operator=(Experiment&&) = default;
  ~Experiment();  ///< if the destructor of an operator crashes, the crash report names the operator

  std::int64_t island = 0;  ///< number of the island of a run that this is, from 1; 0: it is a whole run

  EncodingContext context;  ///< settings that encodings can read
  std::unique_ptr<Encoding> encoding;
  Layout layout;                    ///< of whole genomes; its first section is that of the encoding
  std::vector<Layout> own_layouts;  ///< of each section by itself, as its owner declared it
  std::vector<Varied<Mutation>> mutations;
  std::vector<Varied<Crossover>> crossovers;
  std::vector<Scheduled> devo;
  std::vector<Scored> fitness;
  std::vector<Objective> objectives;  ///< objectives of all fitness operators, in the order of the operators
  std::vector<Over> over_lives;       ///< for each objective, how its scores in several lives become one
  std::vector<Objective> measures;    ///< likewise their scores with other roles
  std::vector<Case> cases;  ///< what selection operators see of the scores in scenarios; refers to `scenarios`

  std::unique_ptr<Selection> selection;         ///< chooses survivors and, if there is no other, parents
  std::unique_ptr<Selection> parent_selection;  ///< chooses parents; null: `selection` does
  std::string child_maker;  ///< name of the one that makes the children itself, without variation; empty: none does
  std::vector<NoteTitle> notes;        ///< what `selection` may note about individuals
  std::vector<NoteTitle> child_notes;  ///< what `parent_selection` may note about the children that it makes
  /// All of these notes: `notes`, and then `child_notes`.
  std::vector<NoteTitle> note_titles() const;
  /// Whether operators develop bodies, or changes replace theirs.
  bool develops_by_operators() const {
    return development.cycles > 0 && !devo.empty() && development.control != Control::no_change;
  }
  /// The operator that chooses parents or makes children, and its index among the selection operators.
  const Selection& breeder() const { return parent_selection ? *parent_selection : *selection; }
  std::size_t breeder_index() const { return parent_selection ? 1 : 0; }
  bool makes_children() const { return !child_maker.empty(); }
  /// The number of individuals that are born in a generation. Those of the first one are at least as many as the
  /// population, unless the selection operator makes them.
  std::int64_t births(std::uint32_t generation) const {
    return generation > 0 || makes_children() ? newborns() : std::max(newborns(), population);
  }

  FileContents files;  ///< of the files that parameters of operators name

  std::vector<OperatorUse> uses;
  std::vector<std::filesystem::path> plugin_folders;  ///< search path of operators, except the program's own folder
  std::vector<std::string> warnings;                  ///< warnings for the user
  std::string device_location;                        ///< place of simulation.device or [simulation], for messages
  std::vector<int>
      gpus;              ///< numbers of the GPUs to use; empty: all. Results do not depend on it, and no run records it
  std::string resolved;  ///< TOML that reads back as the same experiment, with every default written out

  /// Describes a call of the operator with this index (from 0) among those of its kind.
  OperatorCall call_of(std::string_view kind, std::size_t index, CallSubject subject = {}) const;
};

/// Returns the records that the devo operator with this index (from 0) asks for.
RecordRequest devo_request(const Experiment& experiment, std::size_t index);
/// Returns the records that the devo operators which are applied after a cycle ask for, all together: all of these
/// operators, or those from index `first` on.
RecordRequest cycle_request(const Experiment& experiment, std::int64_t cycle, std::size_t first = 0);
/// The names of the numbers that a devo operator remembers about each mass, about each spring and about the body.
struct MemoryNames {
  std::vector<std::string> masses, springs, body;
};
/// Returns the names of what an operator remembers, which one of its functions declares. Throws std::invalid_argument
/// if a name occurs twice, is empty or could not be printed.
std::vector<std::string> checked_names(std::vector<std::string> names, const char* function);
/// Returns the names that a devo operator declares. Throws std::invalid_argument if it gives a name twice, or an empty
/// one, or needs something at birth that it does not declare.
MemoryNames memory_names(const Devo& op);
/// Returns the names of what an encoding gives springs to remember. Throws std::invalid_argument likewise.
std::vector<std::string> spring_memory_names(const Encoding& encoding);
/// Returns the names that the devo operator with this index (from 0) declares.
MemoryNames memory_names(const Experiment& experiment, std::size_t index);
/// Returns what the fitness operator with this index (from 0) asks to observe.
Request fitness_request(const Experiment& experiment, std::size_t index);
/// Returns what the fitness operator that has the first objective asks to observe; nullopt if no operator has one.
std::optional<Request> first_objective_request(const Experiment& experiment);
/// Returns what must be recorded of springs to make the requested records.
Recording recording(const RecordRequest& request);

/// Where an experiment is read from, and how.
struct ExperimentSource {
  std::string file;                 ///< file name, as messages show it; relative paths are relative to its folder
  std::vector<Override> overrides;  ///< applied in order
  std::vector<std::filesystem::path> plugin_path = {};  ///< paths to search for operators after those named in the file
  /// Whether the text is the record of a run, which somebody else may have made. If so, folders of operators that the
  /// text names are ignored with a warning if they no longer exist or if the user has never named them
  /// (plugin_folders.hpp).
  bool is_record = false;
  /// Whether the experiment's own encoding makes the bodies. If so, a dt that is too long for the experiment's masses
  /// and materials is an error. Otherwise the dt is only checked for the body that is given.
  bool grows_bodies = true;
  std::vector<int> gpus = {};  ///< Experiment::gpus
  /// Contents of the files that parameters name, from the record of a run; if not given, the files are read.
  std::optional<FileContents> files = std::nullopt;

  /// The folder of the file, to which paths in it are relative.
  std::filesystem::path folder() const { return std::filesystem::path(file).parent_path(); }
};

/// Reads, checks and composes an experiment:
///
///   file -> overrides -> settings (tables/*) -> libraries of operators -> operators (tables/operators) -> Experiment
///
/// Throws ConfigErrors with all errors, each with the location, the value and a remedy. Throws ConfigError if the text
/// is not valid TOML, or if an override cannot be applied.
Experiment read_experiment(const ExperimentSource& source);
/// Does the same with a text, such as Experiment::resolved in the record of a run.
Experiment read_experiment(std::string_view text, const ExperimentSource& source);
/// Returns whether the file or an override gives a key, such as "development.seed". Throws ConfigError.
bool gives_key(const ExperimentSource& source, std::string_view key);
/// Reads the experiments of all islands of a run from a file, in the order of their numbers; without [islands], the one
/// experiment of the run. Throws like read_experiment(), and ConfigError if the genomes of the islands differ.
std::vector<Experiment> read_islands(const ExperimentSource& source);

}  // namespace evodevo
