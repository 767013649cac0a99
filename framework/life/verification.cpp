#include "life/verification.hpp"

#include <algorithm>
#include <cmath>

#include "cpu/simulator.hpp"
#include "life/birth.hpp"

namespace evodevo {
namespace {

constexpr double enough = 0.5;  ///< fraction of the fitness that an individual must keep, 1
constexpr int perturbed_starts = 3;
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

/// Runs the trials of matured champions and collects the results.
class Trials {
 public:
  Trials(const Experiment& experiment, std::span<const Champion> champions, Matured matured)
      : experiment_(experiment), matured_(std::move(matured)) {
    for (const Champion& champion : champions) verifications_.push_back({champion.newborn.id, champion.fitness, {}});
  }

  /// Applies `change` to a copy of every matured life and repeats its final evaluation.
  template <class Change>
  void add(const std::string& name, Simulator& simulator, const Conditions& conditions, const Change& change) {
    const Evaluation evaluation(experiment_, simulator, conditions);
    const auto change_all = [&](std::vector<Life>& lives) {
      for (Life& life : lives) {
        if (!life.alive()) continue;
        change(life);
        evaluation.simulation.choose_step(life);
      }
    };
    Matured matured = matured_;
    change_all(matured.lives);
    for (auto& [scenario, lives] : matured.in_scenarios) change_all(lives);
    evaluation.measurement.run(matured, unwatched);
    for (std::size_t i = 0; i < matured.lives.size(); ++i) {
      const Result& result = matured.lives[i].result;
      Trial trial{name, result.status, result.reason, std::nullopt};
      if (result.status == Status::ok) trial.value = result.objectives.front();
      verifications_[i].trials.push_back(std::move(trial));
    }
  }

  /// Adds the trials that find artefacts of the step and the method.
  void add_other_steps(const ExactSimulators& exact) {
    const auto unprepare = [](Life& life) { life.living.preparation = nullptr; };  // it belongs to the run's simulator
    const Conditions as_in_the_run(experiment_);
    Conditions quarter = as_in_the_run;
    quarter.step.refine *= step_parts;
    add("quarter-step", *exact.same_method, quarter, unprepare);
    Conditions other = as_in_the_run;
    other.method = other_method(as_in_the_run.method);
    other.step = {.dt = std::nullopt, .refine = step_parts};
    add("other-method", *exact.other_method, other, unprepare);
  }

  /// Adds the trials that find individuals which do not move by themselves.
  void add_passive(Simulator& simulator) {
    const Conditions as_in_the_run(experiment_);
    add("no-muscles", simulator, as_in_the_run, still_muscles);
    Conditions later = as_in_the_run;
    later.later = more_settling;
    add("settled", simulator, later, [](Life&) {});
  }

  std::vector<Verification> take() { return std::move(verifications_); }

 private:
  const Experiment& experiment_;
  Matured matured_;
  std::vector<Verification> verifications_;
};

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
  const Conditions as_in_the_run(experiment);
  const Evaluation run(experiment, simulator);
  Trials trials(experiment, champions, matured(run, champions));
  trials.add("again", simulator, as_in_the_run, [](Life&) {});
  trials.add_other_steps(exact_simulators(experiment));
  for (std::uint32_t i = 0; i < perturbed_starts; ++i)
    trials.add("perturbed-" + std::to_string(i + 1), simulator, as_in_the_run,
               [&](Life& life) { perturb(life, experiment, i); });
  trials.add_passive(simulator);
  return trials.take();
}

ExactSimulators exact_simulators(const Experiment& experiment) {
  const auto simulator = [&](Method method) {
    const Stepping stepping{method, Precision::float64, experiment.stepping.materials};
    return make_cpu_simulator(experiment.scene, stepping, static_cast<int>(experiment.threads));
  };
  const Method method = experiment.stepping.method;
  return {simulator(method), simulator(other_method(method))};
}

std::vector<Verification> verify_marks(const Experiment& experiment, Simulator& simulator, const ExactSimulators& exact,
                                       std::span<const Champion> champions) {
  const Evaluation run(experiment, simulator);
  Trials trials(experiment, champions, matured(run, champions));
  trials.add_other_steps(exact);
  trials.add_passive(simulator);
  return trials.take();
}

bool held(const Verification& verification, const Trial& trial, bool maximise) {
  if (!trial.value) return false;
  const double lost = maximise ? verification.fitness - *trial.value : *trial.value - verification.fitness;
  return lost <= (1 - enough) * std::abs(verification.fitness);
}

namespace {

/// Returns the marks of an individual, each with the first trial that shows it.
std::vector<Mark> all_marks(const Verification& verification, bool maximise) {
  std::vector<Mark> marks;
  const auto mark_by = [&](const char* name, Status status, const auto& shows) {
    const Trial* trial = find(verification, name);
    const bool is_marked = !marks.empty() && marks.back().status == status;
    if (trial != nullptr && !is_marked && shows(*trial)) marks.push_back({status, *trial});
  };
  const auto is_lost = [&](const Trial& trial) { return !held(verification, trial, maximise); };
  mark_by("quarter-step", Status::artefact, is_lost);
  mark_by("other-method", Status::artefact, is_lost);
  if (!maximise || !(verification.fitness > 0)) return marks;
  const double half = enough * verification.fitness;
  mark_by("no-muscles", Status::passive, [&](const Trial& trial) { return trial.value && *trial.value > half; });
  mark_by("settled", Status::passive, [&](const Trial& trial) { return trial.value && *trial.value < half; });
  return marks;
}

}  // namespace

std::vector<std::string> marks(const Verification& verification, bool maximise) {
  std::vector<std::string> names;
  for (const Mark& mark : all_marks(verification, maximise)) names.emplace_back(name(mark.status));
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

}  // namespace evodevo
