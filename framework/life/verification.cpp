#include "life/verification.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "cpu/simulator.hpp"
#include "experiment/device.hpp"
#include "life/birth.hpp"
#include "threads/parallel.hpp"

namespace evodevo {
namespace {

constexpr double enough = 0.5;  ///< fraction of the fitness that an individual must keep, 1
constexpr std::uint32_t perturbed_starts = 3, births = 3;
constexpr double more_settling = 10;  ///< delay of the windows in the trial settled, s
constexpr std::int64_t step_parts = 4;

const Progress unwatched = [](double) {};

Method other_method(Method method) {
  return method == Method::velocity_verlet ? Method::symplectic_euler : Method::velocity_verlet;
}

Matured matured(const Evaluation& evaluation, std::span<const Champion> champions) {
  std::vector<Newborn> newborns;
  for (const Champion& champion : champions) newborns.push_back(champion.newborn);
  return evaluation.matured(evaluation.birth.of(newborns), unwatched);
}

void still_muscles(Life& life) {
  for (Material& material : life.living.body.materials) material.amplitude = 0;
}

/// Returns those of the lives that have these indices.
Matured only(const Matured& all, std::span<const std::size_t> indices) {
  Matured some;
  const auto chosen = [&](const std::vector<Life>& lives) {
    std::vector<Life> copies;
    for (const std::size_t i : indices) copies.push_back(lives[i]);
    return copies;
  };
  some.lives = chosen(all.lives);
  for (const auto& [scenario, lives] : all.in_scenarios) some.in_scenarios[scenario] = chosen(lives);
  return some;
}

/// Returns a trial for each life that has been measured.
std::vector<Trial> trials_of(const std::string& name, std::span<const Life> lives) {
  std::vector<Trial> trials;
  for (const Life& life : lives) {
    trials.push_back({name, life.result.status, life.result.reason, std::nullopt});
    if (life.result.status == Status::ok) trials.back().value = life.result.objectives.front();
  }
  return trials;
}

/// Lets champions live again from birth, perturbed, with other random numbers. Returns a trial for each.
std::vector<Trial> reborn(const Experiment& experiment, Simulator& simulator, std::span<const Champion> champions,
                          std::uint32_t start) {
  Conditions perturbed(experiment);
  perturbed.perturbed_birth = start;
  const Evaluation evaluation(experiment, simulator, perturbed);
  std::vector<Newborn> newborns;  // without records, and of a generation that no run reaches
  for (const Champion& champion : champions)
    newborns.push_back({.id = champion.newborn.id,
                        .generation = std::numeric_limits<std::uint32_t>::max() - start,
                        .genome = champion.newborn.genome,
                        .life = start + 1});
  Matured matured = evaluation.matured(evaluation.birth.of(newborns), unwatched);
  evaluation.measurement.run(matured, unwatched);
  return trials_of("reborn-" + std::to_string(start + 1), matured.lives);
}

/// Repeats final evaluations of matured champions, each time with one thing changed. Several threads may use it.
class Repetition {
 public:
  Repetition(const Experiment& experiment, Matured matured) : experiment_(experiment), matured_(std::move(matured)) {}

  /// Applies `change` to a copy of every matured life and repeats its final evaluation. Returns a trial for each
  /// champion.
  template <class Change>
  std::vector<Trial> with(const std::string& name, Simulator& simulator, const Conditions& conditions,
                          const Change& change) const {
    const Evaluation evaluation(experiment_, simulator, conditions);
    const auto change_all = [&](std::vector<Life>& lives) {
      simulator.workers().for_each(lives.size(), [&](std::size_t i) {
        if (!lives[i].alive()) return;
        change(lives[i]);
        evaluation.simulation.choose_step(lives[i]);
      });
    };
    Matured matured = matured_;
    change_all(matured.lives);
    for (auto& [scenario, lives] : matured.in_scenarios) change_all(lives);
    evaluation.measurement.run(matured, unwatched);
    return trials_of(name, matured.lives);
  }

  /// The trials that find artefacts of the step and the method.
  std::vector<Trial> quarter_step(Simulator& same_method) const {
    Conditions quarter = as_in_the_run_;
    quarter.step.refine *= step_parts;
    return with("quarter-step", same_method, quarter, unprepare);
  }
  std::vector<Trial> other_step(Simulator& another_method) const {
    Conditions other = as_in_the_run_;
    other.method = other_method(as_in_the_run_.method);
    other.step = {.dt = std::nullopt, .refine = step_parts, .unit = as_in_the_run_.step.unit};
    return with("other-method", another_method, other, unprepare);
  }

  /// The trials that find individuals which do not move by themselves.
  std::vector<Trial> no_muscles(Simulator& simulator) const {
    return with("no-muscles", simulator, as_in_the_run_, still_muscles);
  }
  std::vector<Trial> settled(Simulator& simulator) const {
    Conditions later = as_in_the_run_;
    later.later = more_settling;
    return with("settled", simulator, later, [](Life&) {});
  }

  const Conditions& as_in_the_run() const { return as_in_the_run_; }

 private:
  static void unprepare(Life& life) { life.living.preparation = nullptr; }  // it belongs to the run's simulator

  const Experiment& experiment_;
  const Matured matured_;
  const Conditions as_in_the_run_{experiment_};
};

/// Returns a verification for each champion; each element of `trials` has one trial for each champion.
std::vector<Verification> verifications(std::span<const Champion> champions, std::vector<std::vector<Trial>> trials) {
  std::vector<Verification> verifications;
  for (std::size_t i = 0; i < champions.size(); ++i) {
    verifications.push_back({champions[i].newborn.id, champions[i].fitness, {}});
    for (std::vector<Trial>& of_all : trials) verifications.back().trials.push_back(std::move(of_all[i]));
  }
  return verifications;
}

/// Repeats final evaluations, and returns a trial for each champion.
using Repeat = std::function<std::vector<Trial>()>;

/// Makes several repetitions at the same time, since that of a single champion keeps no device busy. Returns the trials
/// of each.
std::vector<std::vector<Trial>> at_once(const std::vector<Repeat>& repeats) {
  std::vector<std::vector<Trial>> trials(repeats.size());
  const int priority_of_caller = Priority::of_this_thread();
  on_own_threads(repeats.size(), [&](std::size_t i) {
    const Priority priority(priority_of_caller);
    trials[i] = repeats[i]();
  });
  return trials;
}

/// Makes simulators in double precision: on the CPU, or on the experiment's device.
ExactSimulators exact_simulators_on(bool cpu, const Experiment& experiment) {
  const auto simulator = [&](Method method) {
    const Stepping stepping{method, Precision::float64, experiment.stepping.materials};
    return cpu ? make_cpu_simulator(experiment.scene, stepping, static_cast<int>(experiment.threads))
               : make_simulator(experiment, stepping);
  };
  const Method method = experiment.stepping.method;
  return {simulator(method), simulator(other_method(method))};
}

const Trial* find(const Verification& verification, const std::string& name) {
  const auto found = std::find_if(verification.trials.begin(), verification.trials.end(),
                                  [&](const Trial& trial) { return trial.name == name; });
  return found == verification.trials.end() ? nullptr : &*found;
}

}  // namespace

bool is_verifiable(const Experiment& experiment) {
  const std::optional<Request> request = first_objective_request(experiment);
  return request && !request->cycle;
}

std::vector<Verification> verify(const Experiment& experiment, Simulator& simulator,
                                 std::span<const Champion> champions) {
  const ExactSimulators exact = exact_simulators_on(true, experiment);
  const Evaluation run(experiment, simulator);
  const Repetition repetition(experiment, matured(run, champions));
  std::vector<Repeat> repeats = {
      [&] { return repetition.with("again", simulator, repetition.as_in_the_run(), [](Life&) {}); },
      [&] { return repetition.quarter_step(*exact.same_method); },
      [&] { return repetition.other_step(*exact.other_method); },
  };
  for (std::uint32_t start = 0; start < perturbed_starts; ++start)
    repeats.push_back([&, start] {
      return repetition.with("perturbed-" + std::to_string(start + 1), simulator, repetition.as_in_the_run(),
                             [&](Life& life) { perturb(life, experiment, start); });
    });
  repeats.push_back([&] { return repetition.no_muscles(simulator); });
  repeats.push_back([&] { return repetition.settled(simulator); });
  if (experiment.development.cycles > 0)  // otherwise, it would be the same as perturbed-1 to -3
    for (std::uint32_t start = 0; start < births; ++start)
      repeats.push_back([&, start] { return reborn(experiment, simulator, champions, start); });
  return verifications(champions, at_once(repeats));
}

ExactSimulators exact_simulators(const Experiment& experiment, const Simulator& simulator) {
  const bool on_cpu = !simulator.device_use();
  ExactSimulators exact = exact_simulators_on(on_cpu, experiment);
  // without a GPU, `auto` would go on with the CPU, and individuals would be verified in another way than before
  if (!on_cpu && exact.same_method->device() != simulator.device())
    throw std::runtime_error("the device " + simulator.device() + " can no longer be used");
  return exact;
}

std::vector<Verification> verify_marks(const Experiment& experiment, Simulator& simulator, const ExactSimulators& exact,
                                       std::span<const Champion> champions, std::size_t most_at_once) {
  using Part = std::function<std::vector<Trial>(const Repetition&)>;
  const Part without_muscles = [&](const Repetition& repetition) { return repetition.no_muscles(simulator); };
  const Part later = [&](const Repetition& repetition) { return repetition.settled(simulator); };
  const Part in_quarters = [&](const Repetition& repetition) { return repetition.quarter_step(*exact.same_method); };
  const Part otherwise = [&](const Repetition& repetition) { return repetition.other_step(*exact.other_method); };
  const bool maximise = experiment.objectives.front().maximise;
  const Evaluation run(experiment, simulator);
  const Matured all = matured(run, champions);
  std::vector<Verification> found = verifications(champions, {});
  std::vector<std::size_t> left(champions.size());  // the champions without a mark
  std::iota(left.begin(), left.end(), std::size_t{0});
  const auto repeat = [&](const std::vector<Part>& parts) {
    if (left.empty()) return;
    const Repetition repetition(experiment, only(all, left));
    std::vector<Repeat> repeats;
    for (const Part& part : parts) repeats.push_back([&] { return part(repetition); });
    for (std::vector<Trial>& trials : at_once(repeats))
      for (std::size_t i = 0; i < left.size(); ++i) found[left[i]].trials.push_back(std::move(trials[i]));
    std::erase_if(left, [&](std::size_t i) { return first_mark(found[i], maximise).has_value(); });
  };
  repeat({without_muscles, later});  // about a tenth of the work of the others
  if (left.size() <= most_at_once) {
    repeat({in_quarters, otherwise});
  } else {
    repeat({in_quarters});
    repeat({otherwise});
  }
  return found;
}

bool held(const Verification& verification, const Trial& trial, bool maximise) {
  if (!trial.value) return false;
  const double lost = maximise ? verification.fitness - *trial.value : *trial.value - verification.fitness;
  return lost <= (1 - enough) * std::abs(verification.fitness);
}

namespace {

/// Returns the marks of an individual, each with the first trial that shows it, in the order of verify_marks().
std::vector<Mark> all_marks(const Verification& verification, bool maximise) {
  std::vector<Mark> marks;
  const auto mark_by = [&](const char* name, Status status, const auto& shows) {
    const Trial* trial = find(verification, name);
    const bool is_marked = !marks.empty() && marks.back().status == status;
    if (trial != nullptr && !is_marked && shows(*trial)) marks.push_back({status, *trial});
  };
  const auto is_lost = [&](const Trial& trial) { return !held(verification, trial, maximise); };
  const double half = enough * verification.fitness;
  if (maximise && verification.fitness > 0) {
    mark_by("no-muscles", Status::passive, [&](const Trial& trial) { return trial.value && *trial.value > half; });
    mark_by("settled", Status::passive, [&](const Trial& trial) { return trial.value && *trial.value < half; });
  }
  mark_by("quarter-step", Status::artefact, is_lost);
  mark_by("other-method", Status::artefact, is_lost);
  return marks;
}

}  // namespace

std::vector<std::string> marks(const Verification& verification, bool maximise) {
  std::vector<std::string> names;
  for (const Mark& mark : all_marks(verification, maximise)) names.emplace_back(name(mark.status));
  std::ranges::sort(names);
  return names;
}

std::optional<Mark> first_mark(const Verification& verification, bool maximise) {
  std::vector<Mark> marks = all_marks(verification, maximise);
  return marks.empty() ? std::nullopt : std::optional(std::move(marks.front()));
}

std::string marks_text(const Verification& verification, bool maximise) {
  std::string text;
  for (const std::string& mark : marks(verification, maximise)) text += (text.empty() ? "" : ", ") + mark;
  return text.empty() ? "verified" : text;
}

std::string verdict_text(const Verification& verification, bool maximise) {
  std::size_t others = 0, kept = 0;
  for (const Trial& trial : verification.trials) {
    if (!trial.name.starts_with("reborn")) continue;
    ++others;
    kept += held(verification, trial, maximise);
  }
  const std::string marks = marks_text(verification, maximise);
  if (others == 0) return marks;
  return marks + " in this life, kept in " + std::to_string(kept) + " of " + std::to_string(others) + " others";
}

}  // namespace evodevo
