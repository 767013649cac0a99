// The momentum of a body, which internal forces conserve.
#pragma once

#include "support.hpp"

namespace evodevo::test {

struct Momentum {
  Vec3 linear, angular;  ///< kg m/s, kg m^2/s about the origin
  double scale = 0;      ///< sum of |m v|, kg m/s
};

inline Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

inline Momentum momentum(const Body& body, const State& state) {
  Momentum sum;
  for (std::size_t i = 0; i < body.masses.size(); ++i) {
    const Vec3 p = body.masses[i].mass * state.velocity[i];
    sum.linear = sum.linear + p;
    sum.angular = sum.angular + cross(state.position[i], p);
    sum.scale += norm(p);
  }
  return sum;
}

}  // namespace evodevo::test
