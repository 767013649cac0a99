#include "analysis/sampling.hpp"

#include <span>

namespace evodevo {
namespace {

std::vector<float> as_floats(std::span<const Vec3> vectors) {
  std::vector<float> floats;
  floats.reserve(3 * vectors.size());
  for (const Vec3& v : vectors)
    for (const double number : {v.x, v.y, v.z}) floats.push_back(static_cast<float>(number));
  return floats;
}

std::vector<float> forces_of(const Body& body, const State& state, double time) {
  std::vector<double> relative_lengths;
  for (const Material& material : body.materials) relative_lengths.push_back(material.relative_length(time));
  std::vector<float> forces;
  forces.reserve(body.springs.size());
  for (const Spring& spring : body.springs) {
    const double distance = norm(state.position[spring.b] - state.position[spring.a]);
    const double length = spring.rest_length * relative_lengths[spring.material];
    // springs between masses at the same place exert no force
    const double force = distance > 0 ? body.stiffness(spring) * (distance - length) : 0;
    forces.push_back(static_cast<float>(force));
  }
  return forces;
}

}  // namespace

Sample sample_of(const Body& body, const State& state, double time, Channels channels) {
  Sample sample{.time = time};
  if (channels.centre) {
    sample.centre = centre_of_mass(body, state.position);
    sample.velocity = centre_of_mass(body, state.velocity);
  }
  if (channels.box) sample.box = bounding_box(state.position);
  if (channels.positions) sample.positions = as_floats(state.position);
  if (channels.velocities) sample.velocities = as_floats(state.velocity);
  if (channels.forces) sample.forces = forces_of(body, state, time);
  return sample;
}

}  // namespace evodevo
