// Conversions between tasks and the data about them that the device reads and writes.
#pragma once

#include <cmath>
#include <vector>

#include "analysis/guard.hpp"
#include "analysis/split_materials.hpp"
#include "core/simulator.hpp"
#include "cuda/layout/formats.hpp"

namespace evodevo::cuda {

/// The description, for the device, of the piece of a run that a task represents. The task's course must have begun.
inline RunPiece run_piece_of(const Task& task) {
  const Course& course = *task.course;
  return {.origin = course.origin,
          .first_step = course.steps,
          .steps = task.steps,
          .bound = course.bound,
          .since_check = static_cast<std::uint32_t>(course.steps % guard_interval),
          .is_last = task.later_steps == 0,
          .left_range = course.left_range};
}

/// The velocities [masses] at which dashpots act at the beginning of a task, m/s. The task's course must have begun.
inline const std::vector<Vec3>& dashpot_velocities_of(const Task& task) {
  return task.course->dashpot_velocity.empty() ? task.state->velocity : task.course->dashpot_velocity;
}

inline bool is_finite(const State& state) {
  double sum = 0;
  for (const std::vector<Vec3>* list : {&state.position, &state.velocity})
    for (const Vec3& v : *list) sum += 0 * v.x + 0 * v.y + 0 * v.z;
  return sum == 0;
}

/// Fills in a task's status, reason, work, times and course from the device's answer.
inline void read_answer(const Answer& answer, Recording recording, Task& task) {
  Course course = *task.course;
  course.steps += answer.steps;
  course.fallen = answer.fallen;
  course.left_range = answer.out_of_range != 0;
  task.spring_evaluations = answer.steps * task.body->springs.size();
  task.work = recording.work ? answer.work : 0;
  if (answer.diverged) {
    task.status = Status::diverged;
    task.ended_at = course.time(task.dt);
    task.work = 0;
    task.clear({}, 0);
    task.samples.clear();
    // after a force has left the range, the motion is wrong, and so are the energies
    if (answer.out_of_range == 0 || !is_finite(*task.state))
      task.reason = divergence_reason(course, task.dt, answer.kinetic, answer.elastic, answer.finite != 0);
    if (task.reason.empty()) task.reason = force_range_reason(course);
  }
  apply_course(task, course);
}

/// The actuator of a material, with its stiffness in units of `resolution` (N).
inline Actuator actuator_of(const Material& material, double resolution) {
  constexpr double pi = 3.14159265358979323846;
  return {material.stiffness / resolution, material.amplitude, material.frequency,
          std::remainder(material.phase, 2 * pi) / pi};
}

/// Writes the coefficients of the dashpots by entry of the table, in units of `resolution` s/m (N); 0 for entry 0,
/// which belongs to no material.
template <class T>
void pack_dashpots(const Body& body, const std::vector<Material>& materials, double resolution, T* to) {
  *to++ = 0;
  for (const double coefficient : dashpot_coefficients(body, materials))
    *to++ = static_cast<T>(coefficient / resolution);
}

/// The time (s) in which a constant acceleration adds as much to an undamped velocity as it adds to a damped one in
/// `time` seconds: (1 - exp(-rate time))/rate.
inline double damped_time(double damping_rate, double time) {
  return damping_rate > 0 ? -std::expm1(-damping_rate * time) / damping_rate : time;
}

/// The scene and a body's step length `dt` (s) as numbers of type T.
template <class T>
StepConstants<T> step_constants(const Scene& scene, double dt) {
  const auto as_t = [](double value) { return static_cast<T>(value); };
  const double rate = scene.damping ? scene.damping->rate : 0;
  return {.acceleration = as_t(scene.gravity ? scene.gravity->downwards() : 0),
          .floor_stiffness = as_t(scene.floor ? scene.floor->stiffness : 0),
          .friction_dt = as_t(scene.friction ? scene.friction->coefficient : 0) * as_t(dt),
          .drag_coefficient = as_t(scene.drag ? scene.drag->coefficient : 0),
          .decay = as_t(std::exp(-rate * dt)),
          .dt = as_t(dt),
          .damped_dt = as_t(damped_time(rate, dt)),
          .half_decay = as_t(std::exp(-rate * dt / 2)),
          .half_damped_dt = as_t(damped_time(rate, dt / 2)),
          .damping_rate = as_t(rate),
          .grade = as_t(scene.gravity ? scene.gravity->grade() : 0),
          .roughness = as_t(scene.floor ? scene.floor->roughness : 0),
          .cells = as_t(scene.floor ? 2 / scene.floor->wavelength : 0),
          .seed = scene.floor ? scene.floor->first_line() : 0,
          .restitution = as_t(scene.floor ? scene.floor->restitution.value_or(0) : 0),
          .friction_coefficient = as_t(scene.friction ? scene.friction->coefficient : 0),
          .static_coefficient = as_t(scene.friction ? scene.friction->holding() : 0),
          .exact_dt = dt};
}

}  // namespace evodevo::cuda
