#include "analysis/guard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "analysis/ground.hpp"
#include "physics/physics.hpp"

namespace evodevo {
namespace {

double epsilon(Precision precision) {
  return precision == Precision::float32 ? std::numeric_limits<float>::epsilon()
                                         : std::numeric_limits<double>::epsilon();
}

/// The largest absolute coordinate of any mass, m.
double extent(const State& state) {
  double largest = 0;
  for (const Vec3& p : state.position) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return largest;
}

/// Sums over the springs of a body for its EnergyBound.
struct SpringSums {
  double drive = 0;     ///< EnergyBound::drive: P/sqrt(2) of guard.hpp, J^(1/2)/s
  double strain = 0;    ///< strain energy of a change of all muscles from full extension to full contraction, J
  double rounding = 0;  ///< strain energy if rounding strains each spring by `rounding` of sums_of(), J
};

/// `rounding`: 16,384 times the machine epsilon; it strains each spring by its product with the sum of the rest length
/// and the largest coordinate. One pass computes all sums, because each of them waits for its own additions.
SpringSums sums_of(const Body& body, const State& state, double rounding) {
  const double positions = extent(state);
  double drive = 0;
  SpringSums sums;
  for (const Spring& spring : body.springs) {
    const Material& material = body.materials[spring.material];
    const double stiffness = body.stiffness(spring);
    const double rate = 2 * 3.14159265358979323846 * material.frequency * material.amplitude * spring.rest_length;
    const double stroke = 2 * material.amplitude * spring.rest_length;
    const double noise = rounding * (spring.rest_length + positions);
    drive += stiffness * rate * rate;
    sums.strain += 0.5 * stiffness * stroke * stroke;
    sums.rounding += 0.5 * stiffness * noise * noise;
  }
  sums.drive = std::sqrt(drive / 2);
  return sums;
}

/// The gravitational energy that masses lose by sinking into the floor, J: m g (m g/k + g dt^2) for each mass, without
/// the first part on a rigid floor.
double sag_allowance(const Body& body, const Scene& scene, double dt) {
  if (!scene.gravity || !scene.floor || (!scene.floor->rigid() && scene.floor->stiffness <= 0)) return 0;
  const double g = scene.gravity->downwards();
  double sum = 0;
  for (const Mass& mass : body.masses) {
    const double sag = scene.floor->rigid() ? 0 : mass.mass * g / scene.floor->stiffness;
    sum += mass.mass * g * (sag + g * dt * dt);
  }
  return sum;
}

/// The energy that a rigid floor gives to masses inside the ground by moving them out, J: their kinetic energy, their
/// weight times their depth, and what springs store whose one end moves by the depth while the other one stays.
double exit_allowance(const Body& body, const State& state, const Scene& scene, double dt) {
  if (!scene.floor || !scene.floor->rigid()) return 0;
  const double g = scene.gravity ? std::max(0.0, scene.gravity->downwards()) : 0;
  std::vector<double> depth;  // m
  double sum = 0;
  for (std::size_t i = 0; i < body.masses.size(); ++i) {
    depth.push_back(std::max(0.0, ground_height(scene, state.position[i]) - state.position[i].z));
    if (depth[i] > 0)
      sum += body.masses[i].mass * (0.5 * std::pow(physics::lowest_rise(-depth[i], dt), 2) + g * depth[i]);
  }
  const auto is_outside = [](double below) { return below == 0; };
  if (std::ranges::all_of(depth, is_outside)) return 0;  // as in most cases; this saves a look at the springs
  for (const Spring& spring : body.springs)
    sum += 0.5 * body.stiffness(spring) * std::pow(std::max(depth[spring.a], depth[spring.b]), 2);
  return sum;
}

/// The sum of mass times height over all masses, kg m.
double height_moment_of(const Body& body, const State& state, const Scene& scene) {
  const double grade = scene.gravity ? scene.gravity->grade() : 0;
  double sum = 0;
  for (std::size_t i = 0; i < body.masses.size(); ++i)
    sum += body.masses[i].mass * physics::height(state.position[i].x, state.position[i].z, grade);
  return sum;
}

}  // namespace

Course course_of(const Task& task, const Scene& scene, Precision precision) {
  if (task.course) return *task.course;
  const Body& body = *task.body;
  const State& state = *task.state;
  const SpringSums sums = sums_of(body, state, 16384 * epsilon(precision));
  const EnergyBound bound{.start = state.start_energy,
                          .drive = sums.drive,
                          .allowance = sums.strain + sums.rounding + sag_allowance(body, scene, task.dt) +
                                       exit_allowance(body, state, scene, task.dt)};
  return {.origin = state.time, .bound = bound, .fallen = fallen_energy(scene, height_moment_of(body, state, scene))};
}

bool is_checked(const Task& task, const Course& course) {
  const std::uint64_t begun = task.course ? task.course->steps : 0;
  return course.steps % guard_interval == 0 || (task.later_steps == 0 && course.steps == begun + task.steps);
}

double fallen_energy(const Scene& scene, double height_moment) {
  return scene.gravity ? std::max(0.0, -scene.gravity->downwards() * height_moment) : 0;
}

std::string divergence_reason(const Course& course, double dt, double kinetic, double elastic, bool finite) {
  const double energy = kinetic + elastic;
  if (!finite || !std::isfinite(energy)) return "non-finite position, velocity or energy";
  const double limit = course.bound.limit(course.elapsed(dt), course.fallen);
  if (!(energy <= limit)) return fmt::format("energy of {:.3g} J above the bound of {:.3g} J", energy, limit);
  return {};
}

std::string force_range_reason(const Course& course) {
  return fmt::format("force range: the force of a spring grew beyond {:.3g} N", course.forces.largest);
}

void apply_course(Task& task, const Course& course) {
  State& state = *task.state;
  state.time = course.time(task.dt);
  state.start_energy = course.bound.start + course.bound.added(course.elapsed(task.dt), course.fallen);
  task.course.reset();
  if (task.status == Status::ok && task.later_steps > 0) task.course = course;
}

}  // namespace evodevo
