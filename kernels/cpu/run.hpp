// One body's run on one CPU thread.
#pragma once

#include "cpu/step.hpp"
#include "scene.hpp"
#include "simulator.hpp"

namespace evodevo::cpu {

/// Moves one task's body by `steps` steps and fills in its answer.
template <class T>
void run(Task& task, const Scene& scene, const Stepping& stepping, const Kernels<T>& kernels, std::uint64_t steps,
         Recording recording);

extern template void run(Task&, const Scene&, const Stepping&, const Kernels<float>&, std::uint64_t, Recording);
extern template void run(Task&, const Scene&, const Stepping&, const Kernels<double>&, std::uint64_t, Recording);

}  // namespace evodevo::cpu
