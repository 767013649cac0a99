// Bodies, scenes and a second simulator for the tests of the physics.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "core/scene.hpp"
#include "core/simulator.hpp"
#include "cpu/simulator.hpp"
#include "evodevo/body.hpp"

namespace evodevo::test {

inline constexpr double pi = 3.14159265358979323846;

/// The method, precision and time step of a test.
struct Steps {
  Method method = Method::paper_euler;
  Precision precision = Precision::float32;
  double dt = 0.0005;  ///< time step [s]

  operator Stepping() const { return {method, precision}; }
};

/// The tolerance of tests in each precision: a little more than the rounding error of a few hundred steps.
inline double tolerance(Precision precision) { return precision == Precision::float32 ? 2e-5 : 1e-12; }
inline std::string name_of(Precision precision) { return precision == Precision::float32 ? "float32" : "float64"; }

inline constexpr std::array all_methods = {Method::paper_euler, Method::symplectic_euler, Method::velocity_verlet,
                                           Method::rk4,         Method::implicit,         Method::xpbd};
static_assert(all_methods.size() == method_names.size());
inline constexpr std::array explicit_methods = {Method::paper_euler, Method::symplectic_euler, Method::velocity_verlet,
                                                Method::rk4};

/// Returns the name of a method for use in the names of tests.
std::string name_of(Method method);

/// The combinations of method and precision for which most tests run.
using Arithmetic = std::tuple<Method, Precision>;
std::string name_of(const Arithmetic& arithmetic);

/// Makes a simulator of a scene, on any device.
using SimulatorFactory = std::function<std::unique_ptr<Simulator>(const Scene&)>;

inline constexpr Recording all_records{
    .stress = true, .work = true, .peak_force = true, .muscle_work = true, .tension = true};

/// A body of one mass at `place`.
Body single_mass(double mass, Vec3 place = {});

/// Two masses of `mass` kg on the x axis, `distance` m apart, with a spring of rest length 1 m between them.
Body pair_of_masses(double mass, const Material& material, double distance = 1);

/// Random points in the unit ball, each joined to its nearest neighbours, with masses from 0.1 to 0.3 kg. Spring i has
/// material i modulo `materials`; the first five materials are the paper's and a mean of two of them.
Body random_body(std::uint32_t masses, std::uint32_t neighbours, std::uint32_t materials, std::uint64_t seed);

/// The same body with a dashpot beside each spring, with damping ratios from 0.05 to 0.25, and with masses of 0.2 kg.
Body with_dashpots(Body body);

/// A lattice of n x n x n voxels with edges of 0.1 m and masses of 0.2 kg.
Body block(std::uint32_t n, const Material& material);

/// The same body without muscles.
Body passive(Body body);

/// Sets all rest lengths to the distances between the rest positions.
void relax(Body& body);

std::vector<Vec3> rest_positions(const Body& body);

/// A scene with all forces.
Scene full_scene();
/// A scene with gravity, floor, friction and damping.
Scene walking_scene();

/// The state of a body at its rest positions with zero velocity; start_energy is set.
State resting(const Body& body, const Scene& scene);

/// The same, but all masses have a velocity (m/s).
State moving(const Body& body, const Scene& scene, Vec3 velocity);

/// A body at birth, but `shift` (m) away and with a velocity (m/s) of all masses; start_energy is set.
State thrown(const Body& body, const Scene& scene, Vec3 shift, Vec3 velocity = {});

/// A body at its rest positions with scattered velocities of at most `speed` m/s along each axis; start_energy is set.
State shaken(const Body& body, double speed);

struct Answer {
  Task task;
  State state;
};

/// Simulates one body.
Answer simulate(Simulator& simulator, const Body& body, const State& state, double dt, std::uint64_t steps,
                Recording recording = {});

/// Simulates one body with one thread.
Answer simulate(const Body& body, const State& state, const Scene& scene, const Steps& stepping, std::uint64_t steps,
                Recording recording = {});

/// The result of a simple implementation in double precision that shares no code with the simulator. It computes one
/// spring after the other, and adds the force at both ends.
struct Reference {
  State state;
  std::vector<double> stress;  ///< stress of each spring [N]
  double work = 0;             ///< work of all muscles [J]
};
Reference reference(const Body& body, State state, const Scene& scene, double dt, std::uint64_t steps);

/// The momentum of a body, which internal forces conserve.
struct Momentum {
  Vec3 linear, angular;  ///< kg m/s, kg m^2/s about the origin
  double scale = 0;      ///< sum of |m v|, kg m/s
};
Momentum momentum(const Body& body, const State& state);

/// Whether all numbers of a result are finite.
bool is_finite(const Task& task, const State& state);

/// The largest distance between the positions of two states, m.
double largest_difference(const State& a, const State& b);

/// Whether two states are bit-identical.
bool same_bits(const State& a, const State& b);

}  // namespace evodevo::test
