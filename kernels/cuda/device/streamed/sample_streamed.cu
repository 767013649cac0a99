// Samples of bodies that streamed.cu simulates. They are taken between the passes over the springs.
#include EVODEVO_METHOD
#include "cuda/device/streamed/gather.cuh"
#include "cuda/device/streamed/sampling_streamed.cuh"

namespace evodevo::cuda {

/// Samples the bodies that have a sample after `step` steps of check span `index`; with 0, after the last step of the
/// span. If a pass ends a step and begins the next, that pass must follow: the end of the step is computed here, and
/// forgotten. The tables hold the lengths of the span; after its last step, row 0 holds the present ones.
extern "C" __global__ void __launch_bounds__(EVODEVO_CHECK_THREADS)
    evodevo_sample_streamed(const Body* bodies, std::uint64_t index, unsigned step) {
  const Body& body = bodies[blockIdx.x];
  const CheckSpan span(body.piece, index);
  if (span.empty() || step >= span.steps() || body.answer->diverged) return;
  const bool at_end = step == 0;
  const std::uint64_t done = span.begin + (at_end ? span.steps() : step);
  NextSample next;
  next.seek(body.sampling, done - 1);
  const unsigned passes = at_end ? span.passes() : step * passes_per_step;
  const auto half = static_cast<unsigned>((passes_before(span, index) + passes) % 2);
  const Point<Number>* positions = body.positions + half * body.masses;
  const bool merged = opening_passes > 0 && !at_end;  // the next pass would end this step
  take_samples(
      body, positions, at_end ? 0 : step * rows_per_step,
      [&](unsigned mass) {
        MassAtEnd at{triple(positions[mass]), triple(body.velocities[mass])};
        if constexpr (work) at.power = body.power[mass];
        if (!merged) return at;
        const SpringForces springs = spring_forces<false>(body, mass, half, Method::row(passes), true);
        if constexpr (work) at.power += springs.power;
        Moving m{at.position, at.velocity, springs.sum, body.mass[mass], body.inverse_mass[mass]};
        Method::Kept kept = reinterpret_cast<const Method::Kept*>(body.scratch)[mass];
        Method::move(body.constants, {passes, true}, kept, m);
        at.velocity = m.velocity;
        return at;
      },
      done, next);
}

}  // namespace evodevo::cuda
