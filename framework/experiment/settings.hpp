// The settings of an experiment: all numbers and options of its file except those of operators.
#pragma once

#include <algorithm>
#include <iosfwd>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/philox.hpp"
#include "core/simulator.hpp"
#include "evodevo/body.hpp"
#include "experiment/choice.hpp"
#include "experiment/time_steps.hpp"

namespace evodevo {

/// The cycles after which a devo operator is applied, counted from 1: from, from + every, and so on up to `to`.
struct Schedule {
  std::int64_t from = 1, to = rng_stream::most_cycles, every = 1;

  bool contains(std::int64_t cycle) const { return cycle >= from && cycle <= to && (cycle - from) % every == 0; }
  /// Returns the number of times that the operator is applied in the cycles 1 to `cycle`.
  std::int64_t applications(std::int64_t cycle) const {
    const std::int64_t last = std::min(cycle, to);
    return last < from ? 0 : (last - from) / every + 1;
  }
  /// Returns the last of the cycles 1 to `cycles` after which the operator is applied; if it is not, one before `from`.
  std::int64_t last(std::int64_t cycles) const { return from + (applications(cycles) - 1) * every; }
};

/// The controls. Each replaces the development by operators with something else, so that the two can be compared.
/// Everything else stays the same, including the simulated time of a life.
enum class Control { off, no_change, random_places, shuffled_stress };
template <>
inline constexpr std::array<std::string_view, 4> names_of<Control>{"off", "no-change", "random-places",
                                                                   "shuffled-stress"};

/// How stress, the mean absolute force of a spring over a cycle, is measured: exactly, or by the paper's tallies
/// (skip_shift.hpp).
enum class Probe { exact, skip_shift };
template <>
inline constexpr std::array<std::string_view, 2> names_of<Probe>{"exact", "skip-shift"};

/// The device that simulates; automatic: a GPU if one can be used, else the CPU.
enum class Device { automatic, cpu, cuda };
template <>
inline constexpr std::array<std::string_view, 3> names_of<Device>{"auto", "cpu", "cuda"};

/// Named sets of default values for the other simulation settings; see accuracy.hpp.
enum class Accuracy { paper, fast, balanced, reference };
template <>
inline constexpr std::array<std::string_view, 4> names_of<Accuracy>{"paper", "fast", "balanced", "reference"};

/// Whose random numbers of development an individual has. Inherited: they follow from the identities of masses
/// (Draws in evodevo/devo.hpp), so that a child develops as its parents did where it is like them; individual: each
/// individual has its own, as in the paper.
enum class DrawsBy { inherited, individual };
template <>
inline constexpr std::array<std::string_view, 2> names_of<DrawsBy>{"inherited", "individual"};

/// Whether the draws of development are the same in all lives of an individual, or anew in each.
enum class DrawsBetweenLives { same, anew };
template <>
inline constexpr std::array<std::string_view, 2> names_of<DrawsBetweenLives>{"same", "new"};

/// The development of a life. In each of `cycles` cycles, the body is simulated for `cycle_time`, then the devo
/// operators are applied (paper, section IV-D).
struct DevelopmentSettings {
  std::int64_t cycles = 0;
  double cycle_time = 1;  ///< simulated time of one cycle, s
  bool reset = false;     ///< whether bodies return to their rest positions after every cycle
  DrawsBy draws = DrawsBy::inherited;
  DrawsBetweenLives draws_between_lives = DrawsBetweenLives::same;
  std::int64_t seed = 1;  ///< of inherited draws; one for all islands
  Control control = Control::off;
  Probe probe = Probe::exact;
  std::int64_t skip = 100;  ///< time steps from one tally to the next; paper, section IV-D1

  bool operator==(const DevelopmentSettings&) const = default;
};

/// A payload that every body carries from birth on. If masses are removed, other masses take over their payload.
struct Payload {
  double share = 0.5;  ///< mass of the payload relative to the body's mass at birth, 1
  double top = 0.1;    ///< upper fraction of the body's height; masses in this part carry the payload, 1

  bool operator==(const Payload&) const = default;
};

/// How individuals are verified before they enter the front: not at all, in the lives that selection has seen, or also
/// in lives to come.
enum class VerifyFront { off, trials, lives };
template <>
inline constexpr std::array<std::string_view, 3> names_of<VerifyFront>{"off", "trials", "lives"};

/// How the scores of several tests, or lives, become one. No scenario has one of these names.
enum class Over { mean, worst, median };
template <>
inline constexpr std::array<std::string_view, 3> names_of<Over>{"mean", "worst", "median"};

/// A test of a robot: the scene in which it is measured, and what is changed about the robot before.
struct Scenario {
  std::string name;
  Scene scene;  ///< the scene of the experiment with the forces that the scenario replaces
  std::optional<Payload> payload;
  double start_noise = 0;   ///< largest offset of a mass along each axis, relative to the body's longest side, 1
  bool muscles = true;      ///< whether muscles are actuated
  double damage = 0;        ///< share of the springs that are lost around a random place, 1
  std::int64_t repeat = 1;  ///< number of repeats, each with its own random numbers
  /// Whether the robot is born and matures in this scene, with this payload; otherwise it has matured in the scene of
  /// the experiment.
  bool develops = false;

  /// Whether something random happens to the robot before it is measured.
  bool is_random() const { return start_noise > 0 || damage > 0; }

  bool operator==(const Scenario&) const = default;
};

/// Which islands send migrants to which others; see neighbours.hpp.
enum class Topology { ring, torus, star, full };
template <>
inline constexpr std::array<std::string_view, 4> names_of<Topology>{"ring", "torus", "star", "full"};

/// Which individuals of an island emigrate.
enum class Emigrants { best, random };
template <>
inline constexpr std::array<std::string_view, 2> names_of<Emigrants>{"best", "random"};

/// Whose place an immigrant takes if selection would drop it; nobody: it is dropped.
enum class Replaced { nobody, worst, random };
template <>
inline constexpr std::array<std::string_view, 3> names_of<Replaced>{"nobody", "worst", "random"};

/// The largest number of lives that an individual may have, with all that [selection] remeasure adds.
inline constexpr std::int64_t most_lives = 100'000;

inline constexpr std::int64_t most_islands = 10'000;

/// The populations of a run with islands, and the migration between them.
struct IslandSettings {
  std::int64_t count = 4;
  Topology topology = Topology::ring;
  std::int64_t every = 10;    ///< generations from one migration to the next
  std::int64_t migrants = 1;  ///< number of individuals that an island sends to each of its neighbours
  Emigrants emigrants = Emigrants::best;
  Replaced replaced = Replaced::nobody;

  /// Whether individuals emigrate after the selection of a generation. They arrive in the next one.
  bool migrate_after(std::uint32_t generation) const { return (generation + std::int64_t{1}) % every == 0; }

  bool operator==(const IslandSettings&) const = default;
};

/// The five base materials (paper, Table I). The second muscle has the opposite phase, as in the paper's source code.
std::map<std::string, Material> base_materials();

struct Settings {
  std::string name;  ///< file name without folder and extension
  std::int64_t seed = 1;
  std::int64_t evaluations = 1000;  ///< number of evaluations in the whole run
  double spring_evaluations = 0;    ///< number of spring evaluations after which the run ends early; 0: no limit
  double hours = 0;                 ///< wall-clock time of all generations after which the run ends early; 0: no limit
  std::int64_t population = 50;
  std::int64_t children = 0;            ///< see newborns(); 0: as many as `population`
  std::int64_t random_individuals = 1;  ///< number of random individuals that enter each generation
  std::int64_t lives = 1;               ///< number of lives of each individual
  double birth_noise = 0;               ///< largest offset of a newborn's mass along each axis, relative to its longest
                                        ///< side, 1
  std::int64_t verify = 1;              ///< number of best individuals to verify when the run ends
  VerifyFront verify_front = VerifyFront::off;  ///< how individuals are verified before they enter the front
  std::int64_t remeasure = 0;  ///< number of members of the population that live again in each generation
  std::string start;  ///< folder of the run with whose last population this one begins; empty: random individuals

  double mass = 0.2;  ///< mass of one point mass, kg
  std::map<std::string, Material> materials = base_materials();
  Scene scene;
  std::optional<Payload> payload;

  Accuracy accuracy = Accuracy::paper;
  Stepping stepping;
  StepRule step;
  Device device = Device::automatic;
  std::int64_t threads = 0;  ///< number of threads on the CPU; 0: one for each core

  DevelopmentSettings development;

  std::optional<IslandSettings> islands;  ///< none: the run has one population

  std::vector<Scenario> scenarios;  ///< none: matured robots are measured in the scene alone

  /// The number of individuals that are born in each generation but the first one (Experiment::births()) and the last
  /// one, which may be smaller.
  std::int64_t newborns() const { return children > 0 ? children : population; }

  bool operator==(const Settings&) const = default;
};

/// Writes the settings as TOML, with every default.
std::ostream& operator<<(std::ostream& stream, const Settings& settings);

/// Reads the settings from the text of an experiment in the record of a run. Ignores the operators. `origin` is the
/// name of the text in messages. Throws ConfigError.
Settings read_settings(std::string_view text, const std::string& origin);

}  // namespace evodevo
