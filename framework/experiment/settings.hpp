// The settings of an experiment: what its file says in numbers and names, without the operators that it composes.
#pragma once

#include <algorithm>
#include <iosfwd>
#include <map>
#include <optional>
#include <string>

#include "base/philox.hpp"
#include "core/simulator.hpp"
#include "evodevo/body.hpp"
#include "experiment/choice.hpp"
#include "experiment/time_steps.hpp"

namespace evodevo {

/// The cycles, from 1, after which a devo operator is applied: from, from + every, ... and none after `to`.
struct Schedule {
  std::int64_t from = 1, to = rng_stream::most_cycles, every = 1;

  bool contains(std::int64_t cycle) const { return cycle >= from && cycle <= to && (cycle - from) % every == 0; }
  /// How often the operator is applied in the cycles 1 to `cycle`.
  std::int64_t applications(std::int64_t cycle) const {
    const std::int64_t last = std::min(cycle, to);
    return last < from ? 0 : (last - from) / every + 1;
  }
};

/// What an experiment on development is compared with: all else stays the same, the simulated time included.
enum class Control { off, no_change, random_places, shuffled_stress };
template <>
inline constexpr std::array<std::string_view, 4> names_of<Control>{"off", "no-change", "random-places",
                                                                   "shuffled-stress"};

/// How stress is measured: as every spring's exact mean force, or by the paper's tallies (skip_shift.hpp).
enum class Probe { exact, skip_shift };
template <>
inline constexpr std::array<std::string_view, 2> names_of<Probe>{"exact", "skip-shift"};

/// Where to simulate; automatic: on a GPU where there is one.
enum class Device { automatic, cpu, cuda };
template <>
inline constexpr std::array<std::string_view, 3> names_of<Device>{"auto", "cpu", "cuda"};

/// What the other settings of the simulation are where the file leaves them out; see accuracy.hpp.
enum class Accuracy { paper, fast, balanced, reference };
template <>
inline constexpr std::array<std::string_view, 4> names_of<Accuracy>{"paper", "fast", "balanced", "reference"};

/// A life's development: `cycles` times {simulate `cycle_time`, apply the operators} (paper, section IV-D).
struct DevelopmentSettings {
  std::int64_t cycles = 0;
  double cycle_time = 1;  ///< s
  bool reset = false;     ///< back to the rest positions after every cycle
  Control control = Control::off;
  Probe probe = Probe::exact;
  std::int64_t skip = 100;  ///< steps from one tally to the next; paper, section IV-D1

  bool operator==(const DevelopmentSettings&) const = default;
};

/// A payload that every body carries from birth on. What masses that go carried comes on others.
struct Payload {
  double share = 0.5;  ///< relative to the body's mass at birth
  double top = 0.1;    ///< the upper part of the body's height that carries it

  bool operator==(const Payload&) const = default;
};

/// The five base materials (paper, Table I; the second muscle in counter-phase, as in its source).
std::map<std::string, Material> base_materials();

struct Settings {
  std::string name;  ///< of the file, without folder and ending
  std::int64_t seed = 1;
  std::int64_t evaluations = 1000;  ///< in the whole run
  double spring_evaluations = 0;    ///< after which the run ends early; 0: it does not
  std::int64_t population = 50;
  std::int64_t random_individuals = 1;  ///< that enter each generation
  std::int64_t verify = 1;              ///< best individuals to verify when the run ends

  double mass = 0.2;  ///< of one point mass, kg
  std::map<std::string, Material> materials = base_materials();
  Scene scene;
  std::optional<Payload> payload;

  Accuracy accuracy = Accuracy::paper;
  Stepping stepping;
  StepRule step;
  Device device = Device::automatic;
  std::int64_t threads = 0;  ///< 0: all cores

  DevelopmentSettings development;

  bool operator==(const Settings&) const = default;
};

/// As TOML, with every default written out.
std::ostream& operator<<(std::ostream& stream, const Settings& settings);

/// The settings in the text of an experiment, which is not from a user but from the record of a run; no operator is
/// looked for. `origin` stands for the file in messages. Throws ConfigError.
Settings read_settings(std::string_view text, const std::string& origin);

}  // namespace evodevo
