// One body's run on one CPU thread.
#pragma once

#include "core/scene.hpp"
#include "core/simulator.hpp"
#include "cpu/step.hpp"

namespace evodevo::cpu {

/// Moves one task's body and fills in its answer.
template <class T>
void run(Task& task, const Scene& scene, const Stepping& stepping, const Kernels<T>& kernels, Recording recording);

extern template void run(Task&, const Scene&, const Stepping&, const Kernels<float>&, Recording);
extern template void run(Task&, const Scene&, const Stepping&, const Kernels<double>&, Recording);

}  // namespace evodevo::cpu
