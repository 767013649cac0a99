#include "life/perturbation.hpp"

#include "base/philox.hpp"

namespace evodevo {

void disturb(Life& life, const Experiment& experiment, std::uint32_t start) {
  constexpr double part = 1e-4;  // of the longest side
  State& state = life.living.state;
  const double most = part * bounding_box(state.position).longest_side();
  Rng rng(philox, {static_cast<std::uint64_t>(experiment.seed), life.newborn.generation, life.newborn.id,
                   place::disturbance + start});
  const auto offset = [&] { return most * (2 * rng.uniform() - 1); };
  for (Vec3& place : state.position) {
    const double x = offset(), y = offset(), z = offset();
    place = place + Vec3{x, y, z};
  }
}

}  // namespace evodevo
