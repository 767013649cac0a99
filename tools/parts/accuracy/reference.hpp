// Solutions of the equations of motion that share no code with the simulator.
#pragma once

#include "core/scene.hpp"
#include "evodevo/body.hpp"

namespace evodevo::tools::accuracy {

/// Where `start`, a state at t = 0, is and how it moves `time` s later, by Boost.Odeint's method of Dormand and Prince
/// with a tolerance of 1e-13 in every step. A floor may be there; friction may not, since it is no force law: throws
/// std::invalid_argument.
State solution(const Body& body, const State& start, const Scene& scene, double time);

/// The largest distance between the positions of two states, m.
double largest_distance(const State& a, const State& b);

}  // namespace evodevo::tools::accuracy
