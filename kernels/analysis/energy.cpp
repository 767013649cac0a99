#include "analysis/energy.hpp"

#include <vector>

#include "analysis/ground.hpp"
#include "physics/physics.hpp"

namespace evodevo {
namespace {

physics::Triple<double> triple(Vec3 v) { return {v.x, v.y, v.z}; }

}  // namespace

double total_energy(const Body& body, const State& state, const Scene& scene) {
  std::vector<double> relative_length;
  for (const Material& material : body.materials) relative_length.push_back(material.relative_length(state.time));
  double energy = 0;
  for (std::size_t i = 0; i < body.masses.size(); ++i) {
    energy += physics::kinetic_energy(body.masses[i].mass, triple(state.velocity[i]));
    if (scene.gravity)
      energy += body.masses[i].mass * scene.gravity->downwards() *
                physics::height(state.position[i].x, state.position[i].z, scene.gravity->grade());
  }
  for (const Spring& spring : body.springs) {
    const auto s = physics::separation(triple(state.position[spring.a]), triple(state.position[spring.b]));
    energy += physics::elastic_energy(s, body.stiffness(spring), spring.rest_length * relative_length[spring.material]);
  }
  return energy;
}

}  // namespace evodevo
