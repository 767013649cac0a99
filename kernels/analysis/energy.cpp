#include "analysis/energy.hpp"

#include "analysis/ground.hpp"

namespace evodevo {
namespace {

physics::Triple<double> triple(Vec3 v) { return {v.x, v.y, v.z}; }

}  // namespace

ElasticEnergy::ElasticEnergy(const Body& body, const State& state) : body_(body) {
  std::vector<double> relative_length;
  for (const Material& material : body.materials) relative_length.push_back(material.relative_length(state.time));
  stretches_.reserve(body.springs.size());
  for (const Spring& spring : body.springs) {
    const auto s = physics::separation(triple(state.position[spring.a]), triple(state.position[spring.b]));
    stretches_.push_back({s, relative_length[spring.material], body.stiffness(spring)});
  }
}

double ElasticEnergy::operator()() const {
  double energy = 0;
  for (std::size_t i = 0; i < stretches_.size(); ++i) {
    const auto& [separation, relative_length, stiffness] = stretches_[i];
    energy += physics::elastic_energy(separation, stiffness, body_.springs[i].rest_length * relative_length);
  }
  return energy;
}

double total_energy(const Body& body, const State& state, const Scene& scene) {
  double energy = ElasticEnergy(body, state)();
  for (std::size_t i = 0; i < body.masses.size(); ++i) {
    energy += physics::kinetic_energy(body.masses[i].mass, triple(state.velocity[i]));
    if (scene.gravity)
      energy += body.masses[i].mass * scene.gravity->downwards() *
                physics::height(state.position[i].x, state.position[i].z, scene.gravity->grade());
  }
  return energy;
}

}  // namespace evodevo
