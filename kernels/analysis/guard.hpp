// The guard against bodies that gain energy by numerical error.
//
// Let K be the kinetic, U the elastic and V the gravitational energy of a body, with V = 0 at the origin, W the energy
// stored in the floor, and F the largest value that -V has had so far (a floor at z = 0 keeps F near 0). Damping, drag,
// dashpots and friction only take energy away, so only the power of muscles can increase K + U + V + W. A spring of
// stiffness k that stores the energy U_i pulls with the force sqrt(2 k U_i). With L' as the rate of change of its
// length L(t), the Cauchy-Schwarz inequality gives
//
//   d(K + U + V + W)/dt <= sum sqrt(2 k U_i) |L'| <= sqrt(2 U) sqrt(sum k L'^2) <= sqrt(2 (K + U + V + W + F)) P,
//   P = sqrt(sum k (2 pi frequency amplitude L0)^2), in J^(1/2)/s,
//
// and therefore, with the energy E (J) at the beginning, after the time t (s)
//
//   K + U <= K + U + V + W + F <= (sqrt(E + F) + t P/sqrt(2))^2.
//
// This bound holds for any exact motion, including resonance. With finite time steps, the energy oscillates around that
// of the exact motion, by a factor of 39 near the largest stable step, and contact increases it a little. The limit is
// therefore ten times the sum of this bound, the strain energy of all muscles from full extension to full contraction,
// the energy of springs strained by rounding, the gravitational energy that masses lose by sinking into the floor, and
// what a rigid floor gives to masses inside it by moving them out. A rigid floor stores no energy. The energy of a body
// that diverges grows beyond 1e20 times this limit.
//
// The bound at the end of a run, without F, becomes the State::start_energy of the next run; development adds the
// energy of its edits. A life that is simulated in cycles therefore has the same bound as a life in one run.
#pragma once

#include <cstdint>
#include <string>

#include "core/course.hpp"
#include "core/scene.hpp"
#include "core/simulator.hpp"
#include "evodevo/body.hpp"

namespace evodevo {

/// Number of steps between two checks of a body, counted from the beginning of its run. A body is also checked at the
/// end of its run.
inline constexpr std::uint64_t guard_interval = 100;

/// The course of a task's run: task.course if an earlier piece has set it, otherwise a new course.
Course course_of(const Task& task, const Scene& scene, Precision precision);

/// Whether a body is checked after `course.steps` steps of its run.
bool is_checked(const Task& task, const Course& course);

/// The gravitational energy (J) that a body has lost by falling below the origin. `height_moment` is the sum over
/// masses of mass times physics::height(), kg m.
double fallen_energy(const Scene& scene, double height_moment);

/// Returns the reason why a body counts as diverged, or an empty text if it does not. `kinetic` and `elastic` are its
/// energies (J); `finite` says whether all its positions and velocities are finite. `course.fallen` must be up to date.
std::string divergence_reason(const Course& course, double dt, double kinetic, double elastic, bool finite);

/// Returns the reason for the divergence of a body in which a spring force has left the range that the device can
/// represent.
std::string force_range_reason(const Course& course);

/// Writes the end of a run into its task: the time and start_energy of its state, and the course for the next piece.
void apply_course(Task& task, const Course& course);

}  // namespace evodevo
