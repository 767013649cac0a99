// The energy of a body and the start of its life.
#include <algorithm>
#include <limits>

#include "physics.hpp"
#include "simulator.hpp"

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
    energy += physics::elastic_energy(s, body.materials[spring.material].stiffness,
                                      spring.rest_length * relative_length[spring.material]);
  }
  return energy;
}

double ground_height(const Scene& scene, const Vec3& place) {
  if (!scene.floor || !scene.floor->rough()) return 0;
  const physics::Roughness<double> rough{scene.floor->roughness, 2 / scene.floor->wavelength,
                                         scene.floor->first_line()};
  return physics::ground_at(place.x, place.y, rough).height;
}

void put_on_ground(std::vector<Vec3>& places, const Scene& scene) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Vec3& place : places) lowest = std::min(lowest, place.z - ground_height(scene, place));
  for (Vec3& place : places) place.z -= lowest;
}

State state_at_birth(const Body& body, const Scene& scene) {
  State state;
  for (const Mass& mass : body.masses) state.position.push_back(mass.rest);
  state.velocity.resize(body.masses.size());
  const Vec3 centre = centre_of_mass(body, state.position);
  for (Vec3& place : state.position) place = place - Vec3{centre.x, centre.y, 0};
  put_on_ground(state.position, scene);
  state.start_energy = total_energy(body, state, scene);
  return state;
}

}  // namespace evodevo
