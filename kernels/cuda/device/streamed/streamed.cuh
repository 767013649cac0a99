// Code shared by the kernels that simulate bodies in the device's memory: the tables of lengths and the check.
#pragma once

#include "cuda/device/check.cuh"
#include "cuda/device/mass_step.cuh"

namespace evodevo::cuda {

using Body = StreamedBody<Number>;

__device__ __forceinline__ Vector triple(const Point<Number>& p) { return {p.x, p.y, p.z}; }
__device__ __forceinline__ Point<Number> point(const Vector& p) { return {p.x, p.y, p.z, 0}; }

/// L/L0; 0 for entry 0, which belongs to empty joints.
__device__ __forceinline__ Number relative_length(const Entry<Number>& entry) {
  return entry.rest_force / physics::maximum(entry.stiffness, Number(1e-30));
}

/// Calls function(index, joint) for each joint of a mass, in a fixed order.
template <class Function>
__device__ __forceinline__ void for_each_joint(const Body& body, unsigned mass, const Function& function) {
  const unsigned end = body.first_row[mass / lanes + 1] * lanes;
  for (unsigned i = body.first_row[mass / lanes] * lanes + mass % lanes; i < end; i += lanes)
    function(i, body.joints[i]);
}

/// A check span: the steps from one check, or the beginning of the piece, to the next check or the end of the piece.
struct CheckSpan {
  std::uint64_t begin, end;

  /// Span `index` of a piece; empty if the piece has fewer spans.
  __device__ __forceinline__ CheckSpan(const RunPiece& piece, std::uint64_t index) {
    begin = min(index == 0 ? 0 : index * guard_interval - piece.since_check, piece.steps);
    end = min((index + 1) * guard_interval - piece.since_check, piece.steps);
  }
  __device__ __forceinline__ bool empty() const { return begin == end; }
  __device__ __forceinline__ unsigned steps() const { return static_cast<unsigned>(end - begin); }
  __device__ __forceinline__ unsigned passes() const {
    return empty() ? 0 : opening_passes + steps() * passes_per_step;
  }
};

/// The number of passes that a body has made before span `index`, which must not be empty.
__device__ __forceinline__ std::uint64_t passes_before(const CheckSpan& span, std::uint64_t index) {
  return index * opening_passes + span.begin * passes_per_step;
}

/// Fills `count` rows of the tables; the first is for the beginning of span `index`. Rows after a body's last step get
/// the lengths at its end.
extern "C" __global__ void evodevo_fill_tables(const Body* bodies, std::uint64_t index, unsigned count) {
  const Body& body = bodies[blockIdx.x];
  const double interval = body.constants.exact_dt / rows_per_step;
  const RunPiece& piece = body.piece;
  const std::uint64_t first = CheckSpan(piece, index).begin * rows_per_step;
  for (unsigned i = threadIdx.x; i < count * body.entries; i += blockDim.x) {
    const Actuator actuator = body.actuators[i % body.entries];
    const std::uint64_t row = min(first + i / body.entries, piece.steps * rows_per_step);
    const double time = piece.origin + static_cast<double>(piece.first_step * rows_per_step + row) * interval;
    body.table[i] = entry_of(actuator, time);
    if constexpr (work) body.rates[i] = length_rate(actuator, time);
  }
}

/// Writes the energies of every body that moved in span `index` into its answer, and marks bodies that have diverged.
/// Row 0 of the tables must hold the current lengths.
extern "C" __global__ void __launch_bounds__(EVODEVO_CHECK_THREADS)
    evodevo_check_streamed(const Body* bodies, std::uint64_t index) {
  const Body& body = bodies[blockIdx.x];
  const CheckSpan span(body.piece, index);
  if (span.empty() || body.answer->diverged) return;
  const StepConstants<Number>& constants = body.constants;
  const Point<Number>* positions = body.positions + (passes_before(span, index) + span.passes()) % 2 * body.masses;
  double kinetic = 0, elastic = 0;
  double height_moment = 0;  // kg m
  double power = 0;          // W
  Number broken = 0;
  for (unsigned mass = threadIdx.x; mass < body.masses; mass += EVODEVO_CHECK_THREADS) {
    const Vector position = triple(positions[mass]), v = triple(body.velocities[mass]);
    kinetic += physics::kinetic_energy(body.mass[mass], v);
    if constexpr (gravity) height_moment += height_moment_of(body.mass[mass], position, constants);
    broken += not_finite(position, v);
    if constexpr (work) {
      power += body.power[mass];
      body.power[mass] = 0;
    }
    for_each_joint(body, mass, [&](unsigned, const Joint<Number> joint) {
      if (!joint.owned) return;
      const Entry<Number> entry = body.table[joint.entry];
      const auto s = physics::separation(position, triple(positions[joint.other]));
      elastic += physics::elastic_energy(s, entry.stiffness, joint.rest_length * relative_length(entry));
    });
  }
  const bool finite = !__syncthreads_or(broken != 0);
  kinetic = block_sum(kinetic, of_warps[0]);
  elastic = block_sum(elastic, of_warps[1]);
  const bool checked = is_checked(body.piece, span.end);
  Answer& answer = *body.answer;
  if constexpr (gravity) {
    height_moment = block_sum(height_moment, of_warps[2]);
    if (threadIdx.x == 0 && checked && finite) record_fall(height_moment, constants, answer);
  }
  if constexpr (work) {
    power = block_sum(power, of_warps[3]);
    if (threadIdx.x == 0) answer.work += constants.exact_dt * power;
  }
  if (threadIdx.x > 0) return;
  answer.steps = span.end;
  answer.kinetic = kinetic;
  answer.elastic = elastic;
  answer.finite = finite;
  answer.diverged = checked && (!finite || has_gained(body.piece, constants, answer));
}

}  // namespace evodevo::cuda
