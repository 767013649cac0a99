// The guard against bodies that gain energy from nothing.
//
// Let K be the kinetic, U the elastic and V the height energy of a body, which counts from the origin, W what the floor
// stores, and F the most that -V has been so far (a floor at z = 0 keeps it near 0). Damping, drag and friction only
// take energy, so K + U + V + W grows by the muscles' power alone. A spring of stiffness k that stores U_i pulls with
// sqrt(2 k U_i), so that by the inequality of Cauchy and Schwarz, L' the rate of its rest length,
//
//   d(K + U + V + W)/dt <= sum sqrt(2 k U_i) |L'| <= sqrt(2 U) sqrt(sum k L'^2) <= sqrt(2 (K + U + V + W + F)) P,
//   P = sqrt(sum k (2 pi frequency amplitude L0)^2), in J^(1/2)/s,
//
// and, from an energy E (J) at the beginning, after t (s)
//
//   K + U <= K + U + V + W + F <= (sqrt(E + F) + t P/sqrt(2))^2.
//
// This holds for any motion, for resonance too. Exact motion stays below it; that of finite steps swings around it,
// near the limit of the step by a factor of 39, and gains a little in contact. So a body may have ten times as much,
// and ten times the strain of all muscles from full extension to full contraction, what rounding strains springs by and
// what masses lose that sag into the floor. One that gains energy from nothing passes 1e20 times that.
//
// What the bound allows a body at the end of a run, less F, is State::start_energy of the next, to which development
// adds what it brings: a life in cycles has the bound of a life in one run.
#pragma once

#include <cstdint>
#include <string>

#include "core/course.hpp"
#include "core/scene.hpp"
#include "core/simulator.hpp"
#include "evodevo/body.hpp"

namespace evodevo {

/// Steps between two checks of a body, counted from where its run began; the run's end is checked too.
inline constexpr std::uint64_t guard_interval = 100;

/// Where a task's run stands: its course, or one that begins now.
Course course_of(const Task& task, const Scene& scene, Precision precision);

/// Whether a body is checked after as many steps as its course has.
bool is_checked(const Task& task, const Course& course);

/// What falling below the origin has set free, J. `height_moment`: the sum of mass times physics::height(), kg m.
double fallen_energy(const Scene& scene, double height_moment);

/// Why a body has diverged; empty where it has not. `kinetic` and `elastic` in J; `finite`: whether all positions and
/// velocities are. The course's `fallen` is that of now.
std::string divergence_reason(const Course& course, double dt, double kinetic, double elastic, bool finite);

/// Sets a task's state and course to those after `course`, which has the steps that it made.
void apply_course(Task& task, const Course& course);

}  // namespace evodevo
