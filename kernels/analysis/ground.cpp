#include "analysis/ground.hpp"

#include <algorithm>
#include <limits>

#include "analysis/energy.hpp"
#include "physics/physics.hpp"

namespace evodevo {

double ground_height(const Scene& scene, const Vec3& position) {
  if (!scene.floor || !scene.floor->rough()) return 0;
  const physics::Roughness<double> rough{scene.floor->roughness, 2 / scene.floor->wavelength,
                                         scene.floor->first_line()};
  return physics::ground_at(position.x, position.y, rough).height;
}

void put_on_ground(std::vector<Vec3>& positions, const Scene& scene) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Vec3& position : positions) lowest = std::min(lowest, position.z - ground_height(scene, position));
  for (Vec3& position : positions) position.z -= lowest;
}

State state_at_birth(const Body& body, const Scene& scene) {
  State state;
  for (const Mass& mass : body.masses) state.position.push_back(mass.rest);
  state.velocity.resize(body.masses.size());
  const Vec3 centre = centre_of_mass(body, state.position);
  for (Vec3& position : state.position) position = position - Vec3{centre.x, centre.y, 0};
  put_on_ground(state.position, scene);
  state.start_energy = total_energy(body, state, scene);
  return state;
}

}  // namespace evodevo
