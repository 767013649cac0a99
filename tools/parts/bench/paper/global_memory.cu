// The baseline that the paper compares its method with (section V-A). Masses are in global memory. In every step, one
// kernel over all springs adds their forces by float atomics, and another kernel moves all masses.
#include "paper/spring_force.cuh"

namespace evodevo::tools::bench {

__device__ __forceinline__ void add(Point<Number>& sum, Number x, Number y, Number z) {
  atomicAdd(&sum.x, x);
  atomicAdd(&sum.y, y);
  atomicAdd(&sum.z, z);
}

/// Adds the forces of all springs. `row` is the row of the material table for this step.
extern "C" __global__ void evodevo_paper_springs(const PaperBatch batch, unsigned row) {
  const PaperBody body = batch.bodies[blockIdx.y];
  const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= body.springs) return;
  const PaperSpring spring = batch.springs[body.first_spring + i];
  const Point<Number>* positions = batch.positions + body.first_mass;
  const auto [force, tension] = pull_of(spring, triple(positions[spring.a]), triple(positions[spring.b]),
                                        batch.table[row * batch.entries + spring.entry]);
  Point<Number>* forces = batch.forces + body.first_mass;
  add(forces[spring.a], force.x, force.y, force.z);
  add(forces[spring.b], -force.x, -force.y, -force.z);
}

/// Moves all masses and resets their spring forces to zero.
extern "C" __global__ void evodevo_paper_masses(const StepConstants<Number> constants, const PaperBatch batch) {
  const PaperBody body = batch.bodies[blockIdx.y];
  const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i >= body.masses) return;
  const unsigned mass = body.first_mass + i;
  move(constants, batch, mass, triple(batch.positions[mass]), triple(batch.forces[mass]));
  batch.forces[mass] = {0, 0, 0, 0};
}

}  // namespace evodevo::tools::bench
