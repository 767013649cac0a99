#include "life/measurement/top_speed.hpp"

#include <limits>

namespace evodevo {

bool moves_by_friction(const Scene& scene) {
  const bool presses_down = scene.gravity && scene.gravity->acceleration > 0;
  const bool carries = scene.floor && (scene.floor->rigid() || scene.floor->stiffness > 0);
  const bool is_level = carries && !scene.floor->rough();
  const bool rubs = scene.friction && scene.friction->holding() > 0;
  const bool swims = scene.drag && scene.drag->coefficient > 0;
  return presses_down && is_level && rubs && !swims;
}

double top_speed(const Scene& scene, double downhill) {
  if (!scene.damping || !(scene.damping->rate > 0)) return std::numeric_limits<double>::infinity();
  const double weight = scene.gravity->downwards();  // per mass, m/s^2
  return weight * (scene.friction->holding() + scene.gravity->grade() * downhill) / scene.damping->rate;
}

}  // namespace evodevo
