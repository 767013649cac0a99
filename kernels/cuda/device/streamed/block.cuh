// Code shared by the methods that simulate a whole body in one thread block (implicit, xpbd). Positions and velocities
// are on the chip if there is room.
#pragma once

#include "cuda/device/streamed/sampling_streamed.cuh"

namespace evodevo::cuda {

extern __shared__ __align__(32) unsigned char chip[];

/// Array `index` of MethodForm::points_on_chip, one point for each mass.
__device__ __forceinline__ Point<Number>* points_on_chip(const Body& body, unsigned index) {
  return reinterpret_cast<Point<Number>*>(chip) + index * body.masses;
}

/// Calls function(mass) for each mass that belongs to this thread.
template <class Function>
__device__ __forceinline__ void for_each_mass(const Body& body, const Function& function) {
  for (unsigned mass = threadIdx.x; mass < body.masses; mass += blockDim.x) function(mass);
}

__device__ __forceinline__ Moving moving(const Body& body, unsigned mass) {
  return {
      triple(body.positions[mass]), triple(body.velocities[mass]), {0, 0, 0}, body.mass[mass], body.inverse_mass[mass]};
}

__device__ __forceinline__ void store(const Body& body, unsigned mass, const Moving& m) {
  body.positions[mass] = point(m.position);
  body.velocities[mass] = point(m.velocity);
}

/// The number of steps of a body's piece so far, and its next sample.
struct Samples {
  std::uint64_t done;
  NextSample next;
};

/// Calls advance(body, count, samples) for the `count` steps of check span `index`, if the body has steps in that span.
/// In `body`, positions and velocities are copied to the chip before and copied back afterwards, if there is room.
template <class Advance>
__device__ __forceinline__ void advance_span(const Body& stored, std::uint64_t index, const Advance& advance) {
  const CheckSpan span(stored.piece, index);
  if (span.empty() || stored.answer->diverged) return;
  [[maybe_unused]] Samples samples;
  if constexpr (sampled) {
    samples.done = span.begin;
    samples.next.seek(stored.sampling, span.begin);
  }
  Body body = stored;
  if (body.on_chip) {
    body.positions = points_on_chip(body, 0);
    body.velocities = points_on_chip(body, 1);
    for_each_mass(body, [&](unsigned mass) { store(body, mass, moving(stored, mass)); });
    __syncthreads();
  }
  advance(body, span.steps(), samples);
  if (body.on_chip) for_each_mass(body, [&](unsigned mass) { store(stored, mass, moving(body, mass)); });
}

/// Counts the contact of a mass at the end of a step.
__device__ __forceinline__ void count_contact(const Body& body, unsigned mass, const Moving& m) {
  if constexpr (contacts && has_floor) body.sampling.contact_steps[mass] += touches(body.constants, m);
}

/// Takes the samples that are due at the end of a step. Row `row` of the tables holds the lengths then.
__device__ __forceinline__ void end_step(const Body& body, unsigned row, [[maybe_unused]] Samples& samples) {
  if constexpr (sampled) {
    if (samples.next.step != ++samples.done) return;
    __syncthreads();
    take_samples(
        body, body.positions, row,
        [&](unsigned mass) {
          MassAtEnd at{triple(body.positions[mass]), triple(body.velocities[mass])};
          if constexpr (work) at.power = body.power[mass];
          return at;
        },
        samples.done, samples.next);
  }
}

/// Records a spring's tension (N) and the part of it without the dashpot, with which its muscle works: adds to the
/// spring's sums at index `joint` and to the sum of power at index `mass`.
__device__ __forceinline__ void record(const Body& body, unsigned row, unsigned joint, unsigned mass, unsigned entry,
                                       Number rest_length, Number tension, Number pull) {
  if constexpr (stress) body.stress[joint] += fabs(tension);
  if constexpr (work) {
    const Number watts = physics::actuation_power(pull, body.rates[row * body.entries + entry] * rest_length);
    body.power[mass] += watts;
    if constexpr (muscle_work) body.powers[joint] += watts;
  }
  if constexpr (peak_force) body.peak[joint] = fmax(body.peak[joint], fabs(tension));
  if constexpr (mean_tension) body.tensions[joint] += tension;
}

}  // namespace evodevo::cuda
