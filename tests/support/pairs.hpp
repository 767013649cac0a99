// Pairs of masses with a closed form, whose fitness is as large as their frequency makes it: individuals that hold,
// that are artefacts of the time step, and that are passive.
#pragma once

#include <algorithm>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "support/experiments.hpp"

namespace evodevo::testing {

inline constexpr double dt = 0.001, mass = 0.2, strain = 0.1;
inline constexpr int measured_step = 100;

inline constexpr int settled_step = measured_step + 10'000;  // in the trial settled

/// Returns the lesser of the positions of an oscillator after `measured_step` and after `settled_step` steps of
/// symplectic Euler from rest at -1. `h` is its angular frequency times the step. The exact amplitude is 1.
inline double lesser_position(double h) {
  double x = -1, v = 0, measured = 0;
  for (int step = 0; step < settled_step; ++step) {
    v -= h * h * x;
    x += v;
    if (step + 1 == measured_step) measured = x;
  }
  return std::min(measured, x);
}

/// Returns an h below the limit of stability, 2, at which the position is at least `least` at both times.
inline double exaggerated(double least) {
  for (float h = 1.8F; h < 1.97F; h += 1e-4F)  // a gene
    if (lesser_position(h) >= least) return h;
  throw std::logic_error("no step makes it that large");
}

/// Two masses 1 m apart, joined by a spring that is 1 + `strain` m long without force. The first gene is the angular
/// frequency of the pair times the time step. If the second gene is 0, a muscle makes the spring that long; otherwise
/// the spring is made so.
class Pair final : public Encoding {
 public:
  Layout layout(const EncodingContext&) const override { return {}; }
  Blueprint decode(const Genome& genome, const Layout&, const EncodingContext& context) const override {
    const double h = genome[0], stiffness = h * h * mass / (2 * dt * dt);
    const bool is_muscle = genome[1] == 0;
    Blueprint blueprint;
    blueprint.body.materials = context.materials;
    const std::uint32_t own =
        blueprint.body.material_index({stiffness, is_muscle ? strain : 0, 0, std::numbers::pi / 2});
    blueprint.body.masses = {{{0, 0, 0}, mass}, {{1, 0, 0}, mass}};
    blueprint.body.springs = {{0, 1, is_muscle ? 1 : 1 + strain, own}};
    return blueprint;
  }
};

/// By how much the spring is longer than without force after `measured_step` steps, m.
class Stretch final : public Fitness {
 public:
  Request observes() const override { return {.settle = measured_step * dt, .window = 0.1}; }
  std::vector<Objective> objectives() const override { return {{"stretch", "m", true}}; }
  std::vector<double> score(const Observation& seen) const override { return {seen.box.longest_side() - (1 + strain)}; }
};

/// An experiment on pairs in empty space, without development, whose front is verified.
inline Experiment pairs() {
  Experiment experiment = testing::read(testing::small_experiment);
  experiment.verify_front = VerifyFront::trials;
  experiment.scene = {};
  experiment.development.cycles = 0;
  experiment.stepping.precision = Precision::float64;
  experiment.step = {.dt = dt, .run_unstable = true};
  experiment.encoding = std::make_unique<Pair>();
  experiment.fitness.clear();
  experiment.fitness.push_back({std::make_unique<Stretch>()});
  experiment.objectives = experiment.fitness[0].op->objectives();
  experiment.cases = {{}};
  return experiment;
}

}  // namespace evodevo::testing
