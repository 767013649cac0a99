// An experiment: settings, and the operators that its TOML file composes.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "evodevo/plugin.hpp"
#include "experiment/overrides.hpp"
#include "experiment/settings.hpp"
#include "operators/operator_use.hpp"

namespace evodevo {

/// A variation operator and how often a child goes through it.
template <class T>
struct Varied {
  std::unique_ptr<T> op;
  std::string name;
  double probability = 0.5;
};

/// A devo operator and when it is applied.
struct Scheduled {
  std::unique_ptr<Devo> op;
  Schedule schedule;
};

struct Experiment : Settings {
  Experiment() = default;
  Experiment(Experiment&&) = default;
  Experiment& operator=(Experiment&&) = default;
  ~Experiment();  ///< names an operator whose end crashes

  EncodingContext context;  ///< the settings that encodings see
  std::unique_ptr<Encoding> encoding;
  Layout layout;  ///< of the encoding's genes
  std::vector<Varied<Mutation>> mutations;
  std::vector<Varied<Crossover>> crossovers;
  std::vector<Scheduled> devo;
  std::vector<std::unique_ptr<Fitness>> fitness;
  std::vector<Objective> objectives;  ///< of all fitness operators, in their order
  std::unique_ptr<Selection> selection;

  std::vector<OperatorUse> uses;
  std::vector<std::filesystem::path> plugin_folders;  ///< where operators were looked for, but for the program's own
  std::vector<std::string> warnings;                  ///< what does not keep it from running, but may not be meant
  std::string device_location;                        ///< where simulation.device is written, for messages
  std::string resolved;  ///< TOML that reads back as this very experiment, with every default written out

  /// A call of the operator that is the index-th of its kind.
  OperatorCall call_of(std::string_view kind, std::size_t index, CallSubject subject = {}) const;
};

/// What a devo operator asks for, the index-th.
SpringRequest devo_request(const Experiment& experiment, std::size_t index);
/// What a fitness operator asks for, the index-th.
Request fitness_request(const Experiment& experiment, std::size_t index);
/// What has to be recorded in a cycle of development for the operators that are applied after it.
Recording recording(const Experiment& experiment, std::int64_t cycle);

/// Where an experiment comes from.
struct ExperimentSource {
  std::string file;                                     ///< for messages, and for what paths in it are relative to
  std::vector<Override> overrides;                      ///< applied in order
  std::vector<std::filesystem::path> plugin_path = {};  ///< where operators are looked for beside those that it names
  /// Whether it is the record of a run, which may come from elsewhere: of the folders that it names those that have
  /// gone, and those that the user has not named, are left out and warned of.
  bool is_record = false;
  /// Whether the bodies are grown by its own encoding, so that its dt must suit its own masses and materials; a body
  /// from elsewhere is judged by itself.
  bool grows_bodies = true;
};

/// Reads, checks and composes an experiment:
///
///   file -> overrides -> settings (tables/*) -> libraries of operators -> operators (tables/operators) -> Experiment
///
/// Throws ConfigError with the location, the value and the remedy.
Experiment read_experiment(const ExperimentSource& source);
/// The same from text, such as the resolved text of a run's record.
Experiment read_experiment(std::string_view text, const ExperimentSource& source);

}  // namespace evodevo
