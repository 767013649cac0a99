// The paper's method (section IV-C2): in every step, a block loads a body's masses into shared memory, adds the
// springs' forces there by float atomics, and writes the moved masses back. The kernel also implements the ways of
// recording stress that the paper tried (section IV-D1).
#include "paper/permutation.hpp"
#include "paper/spring_force.cuh"

namespace evodevo::tools::bench {

constexpr auto stress_method = static_cast<StressMethod>(EVODEVO_STRESS_METHOD);
constexpr bool sums_on = stress_method == StressMethod::sums;
constexpr bool extremes_on = stress_method == StressMethod::extremes;
constexpr bool skip_shift_on = stress_method == StressMethod::skip_shift;

extern __shared__ Number chip[];

/// The positions and the forces of a body's masses in shared memory. Six separate arrays let neighbouring threads use
/// neighbouring memory banks.
struct OnChip {
  Number *x, *y, *z, *fx, *fy, *fz;

  __device__ __forceinline__ explicit OnChip(unsigned masses)
      : x(chip), y(x + masses), z(y + masses), fx(z + masses), fy(fx + masses), fz(fy + masses) {}

  __device__ __forceinline__ Vector position(unsigned mass) const { return {x[mass], y[mass], z[mass]}; }
  __device__ __forceinline__ void add(unsigned mass, Number ax, Number ay, Number az) const {
    atomicAdd(&fx[mass], ax);
    atomicAdd(&fy[mass], ay);
    atomicAdd(&fz[mass], az);
  }
};

__device__ __forceinline__ void load(const PaperBatch& batch, const PaperBody& body, const OnChip& masses) {
  for (unsigned i = threadIdx.x; i < body.masses; i += blockDim.x) {
    const Point<Number> position = batch.positions[body.first_mass + i];
    masses.x[i] = position.x;
    masses.y[i] = position.y;
    masses.z[i] = position.z;
    masses.fx[i] = masses.fy[i] = masses.fz[i] = 0;
  }
}

__device__ __forceinline__ void move_masses(const PaperBatch& batch, const PaperBody& body,
                                            const StepConstants<Number>& constants, const OnChip& masses) {
  for (unsigned i = threadIdx.x; i < body.masses; i += blockDim.x)
    move(constants, batch, body.first_mass + i, masses.position(i), {masses.fx[i], masses.fy[i], masses.fz[i]});
}

/// The least and the most stressed of the springs seen. The upper half of each number holds |force|; the bit patterns
/// of non-negative floats have the same order as their values. The lower half holds the index of the spring, which
/// decides ties.
struct Extremes {
  std::uint64_t least = ~std::uint64_t{0}, most = 0;

  __device__ __forceinline__ void see(Number tension, unsigned which) {
    const std::uint64_t seen = static_cast<std::uint64_t>(__float_as_uint(fabs(tension))) << 32 | which;
    least = min(least, seen);
    most = max(most, seen);
  }
};

/// Adds the forces of a thread's springs, which are every blockDim.x-th spring in `order`: the order of the buffer or,
/// in a tally of Skip-Shift, a random order. With `looks`, returns the least and the most stressed of them.
template <bool looks, class Order>
__device__ __forceinline__ Extremes add_forces(const PaperBatch& batch, const PaperBody& body, const OnChip& masses,
                                               unsigned row, const Order& order) {
  const Entry<Number>* table = batch.table + row * batch.entries;
  Extremes extremes;
  for (unsigned i = threadIdx.x; i < body.springs; i += blockDim.x) {
    const unsigned at = body.first_spring + order(i);
    const PaperSpring spring = batch.springs[at];
    const auto [force, tension] =
        pull_of(spring, masses.position(spring.a), masses.position(spring.b), table[spring.entry]);
    masses.add(spring.a, force.x, force.y, force.z);
    masses.add(spring.b, -force.x, -force.y, -force.z);
    if constexpr (sums_on) atomicAdd(&batch.stress[at], fabs(tension));
    if constexpr (looks) extremes.see(tension, i);
  }
  return extremes;
}

/// Reduces the extremes of all threads of the block; only thread 0 gets the result.
__device__ __forceinline__ Extremes of_block(Extremes extremes) {
  __shared__ std::uint64_t least_of_warp[cuda::lanes], most_of_warp[cuda::lanes];
  const unsigned lane = threadIdx.x % cuda::lanes, warp = threadIdx.x / cuda::lanes;
  const auto reduce_lanes = [&] {
    for (unsigned distance = cuda::lanes / 2; distance > 0; distance /= 2) {
      extremes.least = min(extremes.least, __shfl_down_sync(0xffffffffu, extremes.least, distance));
      extremes.most = max(extremes.most, __shfl_down_sync(0xffffffffu, extremes.most, distance));
    }
  };
  reduce_lanes();
  if (lane == 0) {
    least_of_warp[warp] = extremes.least;
    most_of_warp[warp] = extremes.most;
  }
  __syncthreads();
  if (warp > 0) return extremes;
  extremes = Extremes();
  if (lane < blockDim.x / cuda::lanes) extremes = {least_of_warp[lane], most_of_warp[lane]};
  reduce_lanes();
  return extremes;
}

template <class Order>
__device__ __forceinline__ void count(const PaperBatch& batch, const PaperBody& body, const Extremes& extremes,
                                      const Order& order) {
  atomicAdd(&batch.least[body.first_spring + order(static_cast<unsigned>(extremes.least))], 1u);
  atomicAdd(&batch.most[body.first_spring + order(static_cast<unsigned>(extremes.most))], 1u);
}

/// Simulates one step. `row` is the row of the material table for this step. `tally` is the number of the Skip-Shift
/// tally in this step, counted from 1, or 0 if there is none.
extern "C" __global__ void __launch_bounds__(EVODEVO_THREADS)
    evodevo_paper_step(const StepConstants<Number> constants, const PaperBatch batch, unsigned row, unsigned tally) {
  const PaperBody body = batch.bodies[blockIdx.x];
  const OnChip masses(body.masses);
  load(batch, body, masses);
  __syncthreads();
  const auto in_place = [](unsigned i) { return i; };
  if (skip_shift_on && tally > 0) {
    const Permutation order = shifted(body.springs, blockIdx.x, tally);
    const Extremes extremes = add_forces<true>(batch, body, masses, row, order);
    if (threadIdx.x < body.springs) count(batch, body, extremes, order);
  } else {
    Extremes extremes = add_forces<extremes_on>(batch, body, masses, row, in_place);
    if constexpr (extremes_on) extremes = of_block(extremes);
    if (extremes_on && threadIdx.x == 0 && body.springs > 0) count(batch, body, extremes, in_place);
  }
  __syncthreads();
  move_masses(batch, body, constants, masses);
}

}  // namespace evodevo::tools::bench
