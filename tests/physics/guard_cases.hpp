// Motion near the guard's bound: bodies that muscles drive at resonance, and bodies whose energy grows without a
// source.
#pragma once

#include "hard_cases.hpp"

namespace evodevo::test {

/// Simulates bodies whose muscle is driven at resonance. Expects that the guard stops none of them and that, with
/// methods without numerical damping, the energy is that of the closed form, which is more than strain alone could
/// give.
void expect_resonance_to_live(const SimulatorFactory& simulator_for, Method method);

/// Simulates bodies that gain energy because the floor is too stiff for the time step. Expects that the guard stops
/// some of them, but none if the time step is short.
void expect_pumped_bodies_to_end(const SimulatorFactory& simulator_for);

/// Expects that the bound after several short runs is the same as after one long run, and equals the closed form in
/// guard.hpp.
void expect_one_bound(const SimulatorFactory& simulator_for);

}  // namespace evodevo::test
