// Motion near the guard's bound: bodies that muscles drive as hard as they can, and bodies that gain energy from
// nothing.
#pragma once

#include "hard_cases.hpp"

namespace evodevo::test {

/// A muscle at its body's resonance: expects that it lives, and of methods that keep energy what it has by the closed
/// form, more than strain alone could bring.
void expect_resonance_to_live(const SimulatorFactory& simulator_for, Method method);

/// Bodies that a floor too hard for their step pumps up: expects that some end, and none where the step is short.
void expect_pumped_bodies_to_end(const SimulatorFactory& simulator_for);

/// Expects that the bound after runs of several lengths is that after one, and the closed form of guard.hpp.
void expect_one_bound(const SimulatorFactory& simulator_for);

}  // namespace evodevo::test
