// What the kernels share that move bodies in the device's memory: the tables of lengths and the check.
#pragma once

#include "cuda/device/check.cuh"
#include "cuda/device/mass_step.cuh"

namespace evodevo::cuda {

using Body = StreamedBody<Number>;

__device__ __forceinline__ Place triple(const Point<Number>& p) { return {p.x, p.y, p.z}; }
__device__ __forceinline__ Point<Number> point(const Place& p) { return {p.x, p.y, p.z, 0}; }

/// L/L0; 0 of no material.
__device__ __forceinline__ Number relative_length(const Entry<Number>& entry) {
  return entry.rest_force / physics::maximum(entry.stiffness, Number(1e-30));
}

template <class Function>
__device__ __forceinline__ void for_each_joint(const Body& body, unsigned mass, const Function& function) {
  const unsigned end = body.first_row[mass / lanes + 1] * lanes;
  for (unsigned i = body.first_row[mass / lanes] * lanes + mass % lanes; i < end; i += lanes)
    function(i, body.joints[i]);
}

/// The steps of a stretch from one check to the next, or from its beginning or to its end.
struct Leg {
  std::uint64_t begin, end;

  /// Leg `index`; empty where the stretch has fewer.
  __device__ __forceinline__ Leg(const Stretch& stretch, std::uint64_t index) {
    begin = min(index == 0 ? 0 : index * guard_interval - stretch.since_check, stretch.steps);
    end = min((index + 1) * guard_interval - stretch.since_check, stretch.steps);
  }
  __device__ __forceinline__ bool empty() const { return begin == end; }
  __device__ __forceinline__ unsigned steps() const { return static_cast<unsigned>(end - begin); }
  __device__ __forceinline__ unsigned passes() const {
    return empty() ? 0 : opening_passes + steps() * passes_per_step;
  }
};

/// How many passes a body has made before leg `index`, in which it has steps.
__device__ __forceinline__ std::uint64_t passes_before(const Leg& leg, std::uint64_t index) {
  return index * opening_passes + leg.begin * passes_per_step;
}

/// Fills in `count` rows of the tables, the first of them for the beginning of leg `index`. From a body's last step on
/// they hold the lengths of its end.
extern "C" __global__ void evodevo_fill_tables(const Body* bodies, std::uint64_t index, unsigned count) {
  const Body& body = bodies[blockIdx.x];
  const double interval = body.world.exact_dt / rows_per_step;
  const Stretch& stretch = body.stretch;
  const std::uint64_t first = Leg(stretch, index).begin * rows_per_step;
  for (unsigned i = threadIdx.x; i < count * body.entries; i += blockDim.x) {
    const Actuator actuator = body.actuators[i % body.entries];
    const std::uint64_t row = min(first + i / body.entries, stretch.steps * rows_per_step);
    const double time = stretch.origin + static_cast<double>(stretch.first_step * rows_per_step + row) * interval;
    body.table[i] = entry_of(actuator, time);
    if constexpr (work) body.rates[i] = length_rate(actuator, time);
  }
}

/// Writes down the energies of every body that moved in leg `index`, and stops the ones that have diverged. The tables'
/// row 0 holds the lengths of now.
extern "C" __global__ void __launch_bounds__(EVODEVO_CHECK_THREADS)
    evodevo_check_streamed(const Body* bodies, std::uint64_t index) {
  const Body& body = bodies[blockIdx.x];
  const Leg leg(body.stretch, index);
  if (leg.empty() || body.answer->diverged) return;
  const World<Number>& world = body.world;
  const Point<Number>* places = body.places + (passes_before(leg, index) + leg.passes()) % 2 * body.masses;
  double kinetic = 0, elastic = 0;
  double moment = 0;  // kg m
  double power = 0;   // W
  Number broken = 0;
  for (unsigned mass = threadIdx.x; mass < body.masses; mass += EVODEVO_CHECK_THREADS) {
    const Place place = triple(places[mass]), v = triple(body.velocities[mass]);
    kinetic += physics::kinetic_energy(body.mass[mass], v);
    if constexpr (gravity) moment += moment_of(body.mass[mass], place, world);
    broken += not_finite(place, v);
    if constexpr (work) {
      power += body.power[mass];
      body.power[mass] = 0;
    }
    for_each_joint(body, mass, [&](unsigned, const Joint<Number> joint) {
      if (!joint.owned) return;
      const Entry<Number> entry = body.table[joint.entry];
      const auto s = physics::separation(place, triple(places[joint.other]));
      elastic += physics::elastic_energy(s, entry.stiffness, joint.rest_length * relative_length(entry));
    });
  }
  const bool finite = !__syncthreads_or(broken != 0);
  __shared__ double of_warps[4][lanes];
  kinetic = block_sum(kinetic, of_warps[0]);
  elastic = block_sum(elastic, of_warps[1]);
  const bool checked = is_checked(body.stretch, leg.end);
  Answer& answer = *body.answer;
  if constexpr (gravity) {
    moment = block_sum(moment, of_warps[2]);
    if (threadIdx.x == 0 && checked && finite) note_fall(moment, world, answer);
  }
  if constexpr (work) {
    power = block_sum(power, of_warps[3]);
    if (threadIdx.x == 0) answer.work += world.exact_dt * power;
  }
  if (threadIdx.x > 0) return;
  answer.steps = leg.end;
  answer.kinetic = kinetic;
  answer.elastic = elastic;
  answer.finite = finite;
  answer.diverged = checked && (!finite || has_gained(body.stretch, world, answer));
}

}  // namespace evodevo::cuda
