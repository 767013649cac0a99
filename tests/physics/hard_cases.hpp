// Bodies, scenes and steps at which methods can fail, with the required outcome: a correct result, or a flag with time
// and reason.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "support.hpp"

namespace evodevo::test {

enum class Outcome { right, flagged, right_or_flagged };

struct HardCase {
  std::string name;
  Body body;
  State start;
  Scene scene;
  double dt = 0.0005;  ///< time step [s]
  std::uint64_t steps = 0;
  Outcome outcome = Outcome::right;
  /// Largest energy at the end, if the body is not flagged, relative to the sum of initial energy and the muscles'
  /// work.
  double most_gain = 1.05;
  std::function<void(const State& end)> check = [](const State&) {};  ///< expectations if the body is not flagged
};

/// Returns the cases for one method; some steps and outcomes depend on its stability limits.
std::vector<HardCase> hard_cases(Method method);

using SimulatorFactory = std::function<std::unique_ptr<Simulator>(const Scene&)>;

/// Simulates every case in a batch with two other bodies. Expects the outcome of the case and, for the other bodies,
/// the same bits as when each is simulated alone. `rounding` is the energy that rounding may add to a body at rest, J.
void expect_outcomes(const std::vector<HardCase>& cases, const SimulatorFactory& simulator_for, double rounding = 1e-6);

}  // namespace evodevo::test
