// Bodies, scenes and steps at which methods fail, and what has to come of them: the truth, or a flag with time and
// reason.
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
  double dt = 0.0005;  ///< s
  std::uint64_t steps = 0;
  Outcome outcome = Outcome::right;
  double most_gain = 1.05;  ///< of the energy at the start and the muscles' work, at the end of a life not flagged
  std::function<void(const State& end)> check = [](const State&) {};  ///< what else is then right
};

/// The cases for one method: some of their steps and outcomes are those of its limits.
std::vector<HardCase> hard_cases(Method method);

using SimulatorFactory = std::function<std::unique_ptr<Simulator>(const Scene&)>;

/// Simulates every case between two other bodies, and expects the case's outcome and of the others the bits that they
/// have alone. `rounding`: the energy that it may bring to a body at rest, J.
void expect_outcomes(const std::vector<HardCase>& cases, const SimulatorFactory& simulator_for, double rounding = 1e-6);

}  // namespace evodevo::test
