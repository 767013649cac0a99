#include "life/verification/verification.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <stdexcept>

#include "experiment/device.hpp"
#include "life/birth.hpp"
#include "life/measurement/combining.hpp"
#include "threads/parallel.hpp"

namespace evodevo {
namespace {

constexpr std::uint32_t perturbed_starts = 3, least_new_lives = 3;
static_assert(most_lives < unseen_life::deciding &&
              unseen_life::deciding + (least_new_lives + 1) * most_lives < unseen_life::telling);
constexpr double more_settling = 10;  ///< delay of the windows in the trial settled, s
constexpr std::int64_t step_parts = 4;

const Progress unwatched = [](double) {};

Method other_method(Method method) {
  return method == Method::velocity_verlet ? Method::symplectic_euler : Method::velocity_verlet;
}

std::vector<Newborn> newborns_of(std::span<const Champion> champions) {
  std::vector<Newborn> newborns;
  for (const Champion& champion : champions) newborns.push_back(champion.newborn);
  return newborns;
}

/// Returns all lives of the champions, one champion after the other.
Cohort matured(const Experiment& experiment, const Evaluation& evaluation, std::span<const Champion> champions) {
  const std::vector<Newborn> lives = each_life(experiment, newborns_of(champions));
  return evaluation.matured(evaluation.birth.in_all_scenes(lives), unwatched);
}

void still_muscles(Life& life) {
  for (Material& material : life.living.body.materials) material.amplitude = 0;
}

/// Returns those of the lives that have these indices.
Cohort only(const Cohort& all, std::span<const std::size_t> indices) {
  Cohort some;
  const auto chosen = [&](const std::vector<Life>& lives) {
    std::vector<Life> copies;
    for (const std::size_t i : indices) copies.push_back(lives[i]);
    return copies;
  };
  some.lives = chosen(all.lives);
  for (const auto& [scenario, lives] : all.in_scenarios) some.in_scenarios[scenario] = chosen(lives);
  return some;
}

Trial trial_of(const std::string& name, const Result& result) {
  Trial trial{name, result.status, result.reason, std::nullopt};
  if (result.status == Status::ok) trial.value = result.objectives.front();
  return trial;
}

/// Returns a trial for each newborn from all its lives, which follow each other.
std::vector<Trial> trials_of(const std::string& name, const Experiment& experiment, std::span<const Newborn> newborns,
                             std::vector<Life> lives) {
  std::vector<Trial> trials;
  auto next = lives.begin();
  for (const Newborn& newborn : newborns) {
    std::vector<Result> own;
    for (std::uint32_t i = 0; i < newborn.lives; ++i) own.push_back(std::move((next++)->result));
    trials.push_back(trial_of(name, of_all_lives(experiment, std::move(own), newborn.life)));
  }
  return trials;
}

/// Lets champions live again from birth on. Returns a trial for each. `number` counts the lives to come from 1.
std::vector<Trial> reborn(const Experiment& experiment, Simulator& simulator, std::span<const Champion> champions,
                          bool redrawn, std::uint32_t number) {
  const Evaluation evaluation(experiment, simulator, conditions_to_come(experiment));
  std::vector<Newborn> newborns;
  for (Newborn newborn : newborns_of(champions)) {
    const std::uint32_t seen = newborn.life + newborn.lives - 1;
    newborn.records.clear();
    // the draws of a life that has been seen, or others
    newborn.life = (number - 1) % seen + 1;
    newborn.lives = 1;
    Newborn& life = newborns.emplace_back(each_life(experiment, {&newborn, 1}).front());
    life.life = unseen_life::telling + number;
    if (redrawn) life.draws = life.life;
  }
  Cohort cohort = evaluation.matured(evaluation.birth.in_all_scenes(newborns), unwatched);
  evaluation.measurement.run(cohort, unwatched);
  const std::string name = (redrawn ? redrawn_trial : reborn_trial) + std::to_string(number);
  std::vector<Trial> trials;
  for (const Life& life : cohort.lives) trials.push_back(trial_of(name, life.result));
  return trials;
}

/// The trial that finds individuals whose fitness was luck.
std::vector<Trial> new_lives(const Experiment& experiment, Simulator& simulator, std::span<const Champion> champions) {
  std::vector<Newborn> newborns = newborns_of(champions);
  for (Newborn& newborn : newborns) {
    const std::uint32_t seen = newborn.life + newborn.lives - 1;
    newborn.life = unseen_life::deciding + least_new_lives * seen;  // others if the champion has lived again since
    newborn.lives = std::max(newborn.lives, least_new_lives);
    newborn.records.clear();
  }
  const Evaluation evaluation(experiment, simulator, conditions_to_come(experiment));
  Cohort cohort = evaluation.matured(evaluation.birth.in_all_scenes(each_life(experiment, newborns)), unwatched);
  evaluation.measurement.run(cohort, unwatched);
  for (Newborn& newborn : newborns) newborn.life = 1;  // as messages count them
  return trials_of(new_lives_trial, experiment, newborns, std::move(cohort.lives));
}

/// Repeats final evaluations of matured champions, each time with one thing changed. Several threads may use it.
class Repetition {
 public:
  /// `matured` has all lives of the champions, one champion after the other.
  Repetition(const Experiment& experiment, std::vector<Newborn> champions, Cohort matured)
      : experiment_(experiment), champions_(std::move(champions)), matured_(std::move(matured)) {}

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
    Cohort matured = matured_;
    change_all(matured.lives);
    for (auto& [scenario, lives] : matured.in_scenarios) change_all(lives);
    evaluation.measurement.run(matured, unwatched);
    return trials_of(name, experiment_, champions_, std::move(matured.lives));
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
  const std::vector<Newborn> champions_;
  const Cohort matured_;
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
    return make_simulator(experiment, stepping, cpu ? Device::cpu : experiment.device);
  };
  const Method method = experiment.stepping.method;
  return {simulator(method), simulator(other_method(method))};
}

}  // namespace

bool is_verifiable(const Experiment& experiment) {
  const std::optional<Request> request = first_objective_request(experiment);
  return request && !request->cycle;
}

std::vector<Verification> verify(const Experiment& experiment, Simulator& simulator,
                                 std::span<const Champion> champions, VerifiedLives lives) {
  const ExactSimulators exact = exact_simulators_on(true, experiment);
  const Evaluation run(experiment, simulator);
  const Repetition repetition(experiment, newborns_of(champions), matured(experiment, run, champions));
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
  const bool develop = experiment.development.cycles > 0;
  for (const bool redrawn : {false, true}) {
    // robots that do not develop are born as in perturbed-1 to -3, unless with noise, and draw nothing
    const bool differ = develop || (experiment.birth_noise > 0 && !redrawn);
    for (std::uint32_t birth = 1; differ && lives == VerifiedLives::seen_and_to_come && birth <= births; ++birth)
      repeats.push_back([&, redrawn, birth] { return reborn(experiment, simulator, champions, redrawn, birth); });
  }
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
  using Part = std::function<std::vector<Trial>(const Repetition&, std::span<const Champion>)>;
  const Part without_muscles = [&](const Repetition& repetition, auto) { return repetition.no_muscles(simulator); };
  const Part later = [&](const Repetition& repetition, auto) { return repetition.settled(simulator); };
  const Part in_quarters = [&](const Repetition& repetition, auto) {
    return repetition.quarter_step(*exact.same_method);
  };
  const Part otherwise = [&](const Repetition& repetition, auto) { return repetition.other_step(*exact.other_method); };
  const Part anew = [&](const Repetition&, std::span<const Champion> some) {
    return new_lives(experiment, simulator, some);
  };
  const bool maximise = experiment.objectives.front().maximise;
  const Evaluation run(experiment, simulator);
  const Cohort all = matured(experiment, run, champions);
  std::vector<Verification> found = verifications(champions, {});
  std::vector<std::size_t> left(champions.size());  // the champions without a mark
  std::iota(left.begin(), left.end(), std::size_t{0});
  const auto repeat = [&](const std::vector<Part>& parts) {
    if (left.empty()) return;
    std::vector<Champion> some;
    std::vector<std::size_t> lives;  // of these champions
    for (std::size_t i = 0, first = 0; i < champions.size(); first += champions[i++].newborn.lives) {
      if (!std::ranges::binary_search(left, i)) continue;
      some.push_back(champions[i]);
      for (std::size_t life = 0; life < champions[i].newborn.lives; ++life) lives.push_back(first + life);
    }
    const Repetition repetition(experiment, newborns_of(some), only(all, lives));
    std::vector<Repeat> repeats;
    for (const Part& part : parts) repeats.push_back([&] { return part(repetition, some); });
    for (std::vector<Trial>& trials : at_once(repeats))
      for (std::size_t i = 0; i < left.size(); ++i) found[left[i]].trials.push_back(std::move(trials[i]));
    std::erase_if(left, [&](std::size_t i) { return first_mark(found[i], maximise).has_value(); });
  };
  std::vector<Part> first = {without_muscles, later};  // about a tenth of the work of those in double precision
  if (experiment.verify_front == VerifyFront::lives) first.push_back(anew);
  repeat(first);
  if (left.size() <= most_at_once) {
    repeat({in_quarters, otherwise});
  } else {
    repeat({in_quarters});
    repeat({otherwise});
  }
  return found;
}

}  // namespace evodevo
