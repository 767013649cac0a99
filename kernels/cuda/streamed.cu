// Bodies that are too large for the chip: their state lies in the device's memory, and every step is one launch over
// the masses of all of them. Each mass gathers the forces of its springs in a fixed order, so each spring is computed
// twice.
#include "cuda/check.cuh"
#include "cuda/mass_step.cuh"

namespace evodevo::cuda {

using Body = StreamedBody<Number>;

__device__ __forceinline__ Place triple(const Point<Number>& p) { return {p.x, p.y, p.z}; }

/// The sum of the spring forces at a mass, N. Adds to the sums of stress and power.
__device__ __forceinline__ Place spring_forces(const Body& body, unsigned mass, const Point<Number>* places,
                                               unsigned row) {
  const Entry<Number>* table = body.table + row * body.entries;
  const Place own = triple(places[mass]);
  Place force{0, 0, 0};
  Number power = 0;
  const unsigned end = body.first_row[mass / lanes + 1] * lanes;
  for (unsigned i = body.first_row[mass / lanes] * lanes + mass % lanes; i < end; i += lanes) {
    const Joint<Number> joint = body.joints[i];
    const Entry<Number> entry = table[joint.entry];
    const auto s = physics::separation(own, triple(places[joint.other]));
    const Number inverse = physics::inverse_length(s);
    const Number factor =
        physics::spring_factor_by_inverse(inverse, entry.stiffness, entry.rest_force * joint.rest_length);
    if (joint.owned) {
      const Number tension = factor * physics::length_by_inverse(s, inverse);
      if constexpr (stress) body.stress[i] += fabs(tension);
      if constexpr (work)
        power += physics::actuation_power(tension, body.rates[row * body.entries + joint.entry] * joint.rest_length);
    }
    force.x = physics::multiply_add(factor, s.d.x, force.x);
    force.y = physics::multiply_add(factor, s.d.y, force.y);
    force.z = physics::multiply_add(factor, s.d.z, force.z);
  }
  if constexpr (work) body.power[mass] += power;
  return force;
}

/// Fills in the tables for `count` steps, the first of them `done` steps after the run's beginning. From a body's last
/// step on they hold the lengths of its end.
extern "C" __global__ void evodevo_fill_tables(const Body* bodies, std::uint64_t done, unsigned count) {
  const Body& body = bodies[blockIdx.x];
  for (unsigned i = threadIdx.x; i < count * body.entries; i += blockDim.x) {
    const Actuator actuator = body.actuators[i % body.entries];
    const std::uint64_t step = min(done + i / body.entries, body.steps);
    const double time = body.start_time + static_cast<double>(step) * body.world.exact_dt;
    body.table[i] = entry_of(actuator, time);
    if constexpr (work) body.rates[i] = length_rate(actuator, time);
  }
}

/// Makes step `done` + `row` of all bodies that have as many, with the lengths in the tables' row `row`. Even steps read
/// the first half of the places and write the second, odd ones the other way.
extern "C" __global__ void evodevo_step_streamed(const Body* bodies, std::uint64_t done, unsigned row) {
  const Body& body = bodies[blockIdx.y];
  const unsigned mass = blockIdx.x * blockDim.x + threadIdx.x;
  if (mass >= body.masses || done + row >= body.steps || body.answer->diverged) return;
  const auto half = static_cast<unsigned>((done + row) % 2);
  const Point<Number>* from = body.places + half * body.masses;
  Place place = triple(from[mass]), velocity = triple(body.velocities[mass]);
  const Place force = spring_forces(body, mass, from, row);
  move(body.world, place, velocity, force, body.mass[mass], body.inverse_mass[mass]);
  body.places[(1 - half) * body.masses + mass] = {place.x, place.y, place.z, 0};
  body.velocities[mass] = {velocity.x, velocity.y, velocity.z, 0};
}

/// Writes down the energies of every body that moved in the `now` steps after the first `done`, and stops the ones that
/// have diverged. The tables' row 0 holds the lengths of now.
extern "C" __global__ void __launch_bounds__(EVODEVO_CHECK_THREADS)
    evodevo_check_streamed(const Body* bodies, std::uint64_t done, unsigned now) {
  const Body& body = bodies[blockIdx.x];
  if (done >= body.steps || body.answer->diverged) return;
  const World<Number>& world = body.world;
  const std::uint64_t steps = min(done + now, body.steps);
  const Point<Number>* places = body.places + steps % 2 * body.masses;
  double kinetic = 0, elastic = 0;
  double moment = 0;  // kg m
  double power = 0;   // W
  Number broken = 0;
  for (unsigned mass = threadIdx.x; mass < body.masses; mass += EVODEVO_CHECK_THREADS) {
    const Place place = triple(places[mass]), v = triple(body.velocities[mass]);
    kinetic += physics::kinetic_energy(body.mass[mass], v);
    if constexpr (gravity) moment += static_cast<double>(body.mass[mass]) * place.z;
    broken += not_finite(place, v);
    if constexpr (work) {
      power += body.power[mass];
      body.power[mass] = 0;
    }
    const unsigned end = body.first_row[mass / lanes + 1] * lanes;
    for (unsigned i = body.first_row[mass / lanes] * lanes + mass % lanes; i < end; i += lanes) {
      const Joint<Number> joint = body.joints[i];
      if (!joint.owned) continue;
      const Entry<Number> entry = body.table[joint.entry];
      const Number relative = entry.rest_force / physics::maximum(entry.stiffness, Number(1e-30));
      const auto s = physics::separation(place, triple(places[joint.other]));
      elastic += physics::elastic_energy(s, entry.stiffness, joint.rest_length * relative);
    }
  }
  const bool finite = !__syncthreads_or(broken != 0);
  __shared__ double of_warps[4][lanes];
  kinetic = block_sum(kinetic, of_warps[0]);
  elastic = block_sum(elastic, of_warps[1]);
  double bound = body.energy_bound;
  Answer& answer = *body.answer;
  if constexpr (gravity) {
    moment = block_sum(moment, of_warps[2]);
    bound += fallen_energy(moment, world);
    if (threadIdx.x == 0) answer.moment = moment;
  }
  if constexpr (work) {
    power = block_sum(power, of_warps[3]);
    if (threadIdx.x == 0) answer.work += world.exact_dt * power;
  }
  if (threadIdx.x > 0) return;
  answer.steps = steps;
  answer.kinetic = kinetic;
  answer.elastic = elastic;
  answer.diverged = !finite || !(kinetic + elastic <= bound);
  answer.finite = finite;
}

}  // namespace evodevo::cuda
