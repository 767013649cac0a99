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

  /// Repeats the final evaluation with the method and steps of `conditions`, in double precision on the CPU.
  void add_exact(const std::string& name, const Conditions& conditions) {
    const Stepping stepping{conditions.method, Precision::float64, experiment_.stepping.materials};
    const auto simulator = make_cpu_simulator(experiment_.scene, stepping, static_cast<int>(experiment_.threads));
    add(name, *simulator, conditions, [](Life& life) { life.living.preparation = nullptr; });
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
  for (std::size_t i = 0; i < experiment.fitness.size(); ++i) {
    const auto scores =
        call_operator(experiment.call_of(Fitness::kind, i), [&] { return experiment.fitness[i].op->objectives(); });
    const auto is_objective = [](const Objective& score) { return score.role == Role::objective; };
    if (std::any_of(scores.begin(), scores.end(), is_objective)) return !fitness_request(experiment, i).cycle;
  }
  return false;
}

std::vector<Verification> verify(const Experiment& experiment, Simulator& simulator,
                                 std::span<const Champion> champions) {
  const Conditions as_in_the_run(experiment);
  const Evaluation run(experiment, simulator);
  Trials trials(experiment, champions, matured(run, champions));
  trials.add("again", simulator, as_in_the_run, [](Life&) {});

  Conditions quarter = as_in_the_run;
  quarter.step.refine *= step_parts;
  trials.add_exact("quarter-step", quarter);
  Conditions other = as_in_the_run;
  other.method = as_in_the_run.method == Method::velocity_verlet ? Method::symplectic_euler : Method::velocity_verlet;
  other.step = {.dt = std::nullopt, .refine = step_parts};
  trials.add_exact("other-method", other);

  for (std::uint32_t i = 0; i < perturbed_starts; ++i)
    trials.add("perturbed-" + std::to_string(i + 1), simulator, as_in_the_run,
               [&](Life& life) { perturb(life, experiment, i); });
  trials.add("no-muscles", simulator, as_in_the_run, still_muscles);
  Conditions later = as_in_the_run;
  later.later = more_settling;
  trials.add("settled", simulator, later, [](Life&) {});
  return trials.take();
}

bool held(const Verification& verification, const Trial& trial, bool maximise) {
  if (!trial.value) return false;
  const double fitness = verification.fitness;
  if (maximise && fitness > 0) return *trial.value >= enough * fitness;
  return std::abs(*trial.value - fitness) <= enough * std::abs(fitness);
}

std::vector<std::string> marks(const Verification& verification, bool maximise) {
  const auto lost = [&](const std::string& name) {
    const Trial* trial = find(verification, name);
    return trial != nullptr && !held(verification, *trial, maximise);
  };
  std::vector<std::string> marks;
  if (lost("quarter-step") || lost("other-method")) marks.emplace_back("artefact");
  if (!maximise || !(verification.fitness > 0)) return marks;
  const Trial *still = find(verification, "no-muscles"), *settled = find(verification, "settled");
  const bool needs_no_muscles = still != nullptr && still->value && *still->value > enough * verification.fitness;
  const bool comes_to_rest = settled != nullptr && settled->value && *settled->value < enough * verification.fitness;
  if (needs_no_muscles || comes_to_rest) marks.emplace_back("passive");
  return marks;
}

std::string marks_text(const Verification& verification, bool maximise) {
  std::string text;
  for (const std::string& mark : marks(verification, maximise)) text += (text.empty() ? "" : ", ") + mark;
  return text.empty() ? "verified" : text;
}

}  // namespace evodevo
