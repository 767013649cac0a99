// An experiment: the settings and operators that a TOML file composes.
#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/philox.hpp"
#include "core/simulator.hpp"
#include "evodevo/plugin.hpp"
#include "experiment/overrides.hpp"
#include "experiment/time_steps.hpp"
#include "operators/loader.hpp"
#include "operators/operator_call.hpp"

namespace evodevo {

/// A variation operator and how often a child goes through it.
template <class T>
struct Varied {
  std::unique_ptr<T> op;
  std::string name;
  double probability = 0.5;
};

/// The cycles, from 1, after which a devo operator comes to its turn: from, from + every, ... and none after `to`.
struct Schedule {
  std::int64_t from = 1, to = place::most_cycles, every = 1;

  bool contains(std::int64_t cycle) const { return cycle >= from && cycle <= to && (cycle - from) % every == 0; }
  /// How many turns there are in the cycles 1 to `cycle`.
  std::int64_t turns(std::int64_t cycle) const {
    const std::int64_t last = std::min(cycle, to);
    return last < from ? 0 : (last - from) / every + 1;
  }
};

/// A devo operator and when it comes to its turn.
struct Scheduled {
  std::unique_ptr<Devo> op;
  Schedule schedule;
};

/// What an experiment on development is compared with: all else stays the same, the simulated time included.
enum class Control { off, no_change, random_places, shuffled_stress };
inline constexpr std::array control_names{"off", "no-change", "random-places", "shuffled-stress"};
inline const char* name(Control control) { return control_names[static_cast<std::size_t>(control)]; }

/// How stress is known: by every spring's exact mean force, or by the paper's tallies (skip_shift.hpp).
enum class Probe { exact, skip_shift };

/// A life's development: `cycles` times {simulate `cycle_time`, apply the operators} (paper, section IV-D).
struct Development {
  std::int64_t cycles = 0;
  double cycle_time = 1;  ///< s
  bool reset = false;     ///< back to the rest places after every cycle
  Control control = Control::off;
  Probe probe = Probe::exact;
  std::int64_t skip = 100;  ///< steps from one tally to the next; paper, section IV-D1
  std::vector<Scheduled> operators;
};

/// A load that every body carries from birth on. What masses that go carried comes on others.
struct Load {
  double share = 0.5;  ///< relative to the body's mass at birth
  double top = 0.1;    ///< the upper part of the body's height that carries it
};

/// An operator that the experiment uses, for the record.
struct OperatorUse {
  std::string kind, name, version;
  std::filesystem::path file;
  std::string hash;                      ///< of the file
  const OperatorTitle* title = nullptr;  ///< nullptr in a record
};

struct Experiment {
  Experiment() = default;
  Experiment(Experiment&&) = default;
  Experiment& operator=(Experiment&&) = default;
  ~Experiment();  ///< names an operator whose end crashes

  std::string name;  ///< of the file, without folder and ending
  std::int64_t seed = 1;
  std::int64_t evaluations = 1000;  ///< in the whole run
  double spring_evaluations = 0;    ///< after which the run ends early; 0: it does not
  std::int64_t population = 50;
  std::int64_t newcomers = 1;  ///< random individuals that enter each generation
  std::int64_t verify = 1;     ///< best individuals to verify when the run ends

  World world;
  std::unique_ptr<Encoding> encoding;
  Layout layout;  ///< of the encoding's genes
  std::vector<Varied<Mutation>> mutations;
  std::vector<Varied<Crossover>> crossovers;
  Scene scene;
  std::optional<Load> load;
  Stepping stepping;
  StepRule step;
  std::string device = "auto";
  std::string device_place;  ///< where that is written, for messages
  std::int64_t threads = 0;  ///< 0: all cores
  Development development;
  std::vector<std::unique_ptr<Fitness>> fitness;
  std::vector<Objective> objectives;  ///< of all fitness operators, in their order
  std::unique_ptr<Selection> selection;

  std::vector<OperatorUse> uses;
  std::vector<std::filesystem::path> plugin_folders;  ///< where operators were looked for, but for the program's own
  std::vector<std::string> warnings;                  ///< what does not keep it from running, but may not be meant
  std::string resolved;  ///< TOML that reads back as this very experiment, with every default written out
};

/// The operator that is the index-th of its kind; nullptr for one that no library has brought.
const OperatorUse* use_of(const Experiment& experiment, std::string_view kind, std::size_t index);

/// Throws std::runtime_error that names the call and `what`, and the remedy.
[[noreturn]] void blame_operator(const OperatorCall& call, std::string_view kind, const std::string& what);

/// Calls the own code of an operator, the index-th of its kind, and blames it for what it throws. All such calls go
/// through here, or, while the experiment is being read, through in_operator().
template <class Call>
decltype(auto) call_operator(const Experiment& experiment, std::string_view kind, std::size_t index, CallPlace place,
                             const Call& call) {
  const OperatorUse* use = use_of(experiment, kind, index);
  const OperatorCall whose{use != nullptr ? use->title : nullptr, place, experiment.seed};
  try {
    return in_operator(whose, call);
  } catch (const std::exception& error) {
    blame_operator(whose, kind, error.what());
  }
}

/// What a devo operator asks for, the index-th.
SpringRequest devo_request(const Experiment& experiment, std::size_t index);
/// What a fitness operator asks for, the index-th.
Request fitness_request(const Experiment& experiment, std::size_t index);
/// What has to be recorded in a cycle of development for the operators whose turn it is.
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

/// Reads, checks and composes an experiment. Throws ConfigError with the place, the value and the remedy.
Experiment read_experiment(const ExperimentSource& source);
/// The same from text, such as the resolved text of a run's record.
Experiment read_experiment(std::string_view text, const ExperimentSource& source);

/// The five base materials (paper, Table I; the second muscle in counter-phase, as in its source).
std::map<std::string, Material> base_materials();

}  // namespace evodevo
