// Solutions of the equations of motion that share no code with the simulator.
#pragma once

#include "core/scene.hpp"
#include "evodevo/body.hpp"

namespace evodevo::tools::accuracy {

/// Returns the state `time` s after `start`, which is a state at t = 0. It is computed by the Dormand-Prince method of
/// Boost.Odeint with a tolerance of 1e-13 in every step. The scene may have a floor, but no friction, which is not
/// given by a force law. Throws std::invalid_argument if the scene has friction.
State solution(const Body& body, const State& start, const Scene& scene, double time);

/// The largest distance between the positions of two states, m.
double largest_distance(const State& a, const State& b);

}  // namespace evodevo::tools::accuracy
