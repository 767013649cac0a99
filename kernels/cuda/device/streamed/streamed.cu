// Bodies that are too large for the chip. Their state is in the device's memory, and every pass over the springs is a
// launch over the masses of all these bodies:
//
//   positions, velocities ─► spring_forces (gathered by each mass) ─► Method::move ─► positions, velocities
//
// A mass gathers the forces of its springs in a fixed order, so each spring is computed twice.
#include EVODEVO_METHOD
#include "cuda/device/streamed/gather.cuh"

namespace evodevo::cuda {

static_assert(sizeof(Method::Kept) <= (EVODEVO_NUMBERS_OF_MASS > 0 ? EVODEVO_NUMBERS_OF_MASS * sizeof(Number) : 1));

/// Computes pass `pass` of check span `index` for all bodies whose span has that pass. The tables hold the lengths of
/// this span. Counted from the beginning of the piece, even passes read the first half of the positions and write the
/// second; odd passes do the reverse.
extern "C" __global__ void evodevo_pass_streamed(const Body* bodies, std::uint64_t index, unsigned pass) {
  const Body& body = bodies[blockIdx.y];
  const unsigned mass = blockIdx.x * blockDim.x + threadIdx.x;
  const CheckSpan span(body.piece, index);
  if (mass >= body.masses || pass >= span.passes() || body.answer->diverged) return;
  const auto half = static_cast<unsigned>((passes_before(span, index) + pass) % 2);
  const Vector position = triple(body.positions[half * body.masses + mass]), velocity = triple(body.velocities[mass]);
  const SpringForces springs = spring_forces<true>(body, mass, half, Method::row(pass), Method::is_recorded(pass));
  if constexpr (work) body.power[mass] += springs.power;
  Moving m{position, velocity, springs.sum, body.mass[mass], body.inverse_mass[mass]};
  const Pass of_span{pass, pass + 1 == span.passes()};
  Method::move(body.constants, of_span, reinterpret_cast<Method::Kept*>(body.scratch)[mass], m);
  body.positions[(1 - half) * body.masses + mass] = point(m.position);
  body.velocities[mass] = point(m.velocity);
  if constexpr (dashpots) {
    const Vector before = triple(body.dashpot_velocities[half * body.masses + mass]);
    body.dashpot_velocities[(1 - half) * body.masses + mass] =
        point(Method::dashpot_velocity(body.constants, of_span, m, before));
  }
  if constexpr (contacts && has_floor)
    if (Method::ends_motion(of_span)) body.sampling.contact_steps[mass] += touches(body.constants, m);
}

}  // namespace evodevo::cuda
