// Simulates one body on one CPU thread.
#pragma once

#include "core/scene.hpp"
#include "core/simulator.hpp"
#include "cpu/step.hpp"

namespace evodevo::cpu {

/// Simulates one task and fills in its result.
///
///   arrange   body, state ─► arrays in Layout's order
///   repeat until the end or a divergence, up to the next check:
///     actuate   times ─► relative lengths of the materials
///     advance   arrays, lengths ─► arrays after the steps up to the check; samples on the way
///     collect   sums of the slots ─► records of the springs
///     check     energies ─► status
///   write     arrays ─► state; sums ─► means over the run
template <class T>
void run(Task& task, const Scene& scene, const Stepping& stepping, const Kernels<T>& kernels, Recording recording);

extern template void run(Task&, const Scene&, const Stepping&, const Kernels<float>&, Recording);
extern template void run(Task&, const Scene&, const Stepping&, const Kernels<double>&, Recording);

}  // namespace evodevo::cpu
