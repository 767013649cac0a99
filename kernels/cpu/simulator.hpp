// The simulator on the CPU.
#pragma once

#include <memory>

#include "core/simulator.hpp"

namespace evodevo {

/// Makes a simulator on the CPU with `threads` threads (0: one per core). It uses the best instruction set that the
/// processor has.
std::unique_ptr<Simulator> make_cpu_simulator(const Scene& scene, const Stepping& stepping, int threads);

}  // namespace evodevo
