// A lattice of voxels with springs of their own as an elastic material: the modulus, the bending stiffness and the mass
// that its springs and masses stand for. experiments/published uses this to map voxels of a given modulus and density
// to springs and masses.
#include <cmath>

#include "analysis/energy.hpp"
#include "evodevo/lattice.hpp"
#include "ways.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

// those of experiments/published/kriegman-2018
constexpr double edge = 0.01, mass = 1, stiffness = 6597.2, ratio = 1, rate = 4.47;  // m, kg, N/m, 1, 1/s

constexpr Steps fine{Method::velocity_verlet, Precision::float64, 1e-4};

/// A body as the encoding `voxel` makes it with springs = "own"; tests/operators compares the two.
Body voxels(std::array<std::uint32_t, 3> size, double damping) {
  const Lattice lattice = make_lattice(size, edge);
  Body body;
  body.materials = {{stiffness, 0, 0, 0, damping}};
  for (const Vec3& corner : lattice.corners) body.masses.push_back({corner, 0});
  for (const LatticeSpring& s : lattice.springs)
    for (std::size_t i = 0; i < s.voxels.size(); ++i) {
      body.springs.push_back({s.a, s.b, norm(lattice.corners[s.b] - lattice.corners[s.a]), 0});
      if (lattice.is_body_diagonal(s))
        for (const std::uint32_t end : {s.a, s.b}) body.masses[end].mass += mass / 8;
    }
  return body;
}

/// The mean height of the masses that began at the height `z` (m).
double height(const Body& body, const State& state, double z) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < body.masses.size(); ++i)
    if (std::abs(body.masses[i].rest.z - z) < edge / 2) {
      sum += state.position[i].z;
      ++count;
    }
  return sum / count;
}

/// Lets a column with a section of `x` by `y` voxels sag under its weight on a floor without friction; returns the
/// modulus of its middle layer (Pa), which is far from the ends: the pressure of the sections above it, by the share by
/// which it is thinner than a voxel. Gravity is weak, so that this is less than 0.1 %.
double modulus(std::uint32_t x, std::uint32_t y) {
  constexpr std::uint32_t layers = 13, below = 6;
  Scene scene{Gravity{0.01}, Floor{}, {}, {}, {}};
  scene.floor->restitution = 0;
  const Body body = voxels({x, y, layers}, ratio);
  const Answer a = simulate_ok(body, resting(body, scene), scene, fine, 40000);
  const double thinner = 1 - (height(body, a.state, (below + 1) * edge) - height(body, a.state, below * edge)) / edge;
  EXPECT_LT(thinner, 1e-3);
  const double above = x * y * (layers - below - 0.5) * mass * scene.gravity->acceleration;
  return above / (x * y * edge * edge) / thinner;
}

TEST(VoxelLattice, AColumnHasTheModulusOfItsSpringsWhateverItsSection) {
  // C11 - 2 C12^2/(C11 + C12), with C11 = 28/3 k/h and C12 = 10/3 k/h
  EXPECT_NEAR(modulus(1, 1) / (stiffness / edge), 144.0 / 19, 0.001 * 144 / 19);
  EXPECT_NEAR(modulus(4, 3), 5e6, 0.001 * 5e6) << "as published";
}

TEST(Lattice, TenVoxelsASideAreThePapersBody) {
  const Lattice lattice = make_lattice({10, 10, 10}, 0.1);
  EXPECT_EQ(lattice.corners.size(), 1331u);
  EXPECT_EQ(lattice.springs.size(), 14230u);
}

/// The first frequency (Hz) of a cantilever of single voxels along x, without damping. It starts with velocities in the
/// shape of the first mode, of which `root` is the root of cos x cosh x = -1.
double first_frequency(std::uint32_t levels, double root, double expected) {
  Body beam = voxels({levels, 1, 1}, 0);
  const double length = levels * edge;
  State start = resting(beam, {});
  const double part = (std::cosh(root) + std::cos(root)) / (std::sinh(root) + std::sin(root));
  std::size_t end = 0;
  for (std::size_t i = 0; i < beam.masses.size(); ++i) {
    const double x = beam.masses[i].rest.x, at = root * x / length;
    if (x < edge / 2) beam.masses[i].mass = 0;  // held
    if (x > length - edge / 2) end = i;
    start.velocity[i].z =
        1e-3 * length * expected * (std::cosh(at) - std::cos(at) - part * (std::sinh(at) - std::sin(at)));
  }
  start.start_energy = total_energy(beam, start, {});
  const std::uint64_t interval = 50;
  double before = 0, first = 0, last = 0;
  int passes = 0;
  State state = start;
  for (int i = 1; passes < 5; ++i) {
    const Answer a = simulate(beam, state, {}, fine, interval);
    state = a.state;
    const double now = state.position[end].z - start.position[end].z;
    if (before * now < 0) {
      last = (i - now / (now - before)) * static_cast<double>(interval) * fine.dt;
      if (passes++ == 0) first = last;
    }
    before = now;
  }
  return (passes - 1) / (last - first) / 2;
}

TEST(VoxelLattice, ABeamSwingsAsEulerAndBernoulliSay) {
  // EI = 4/3 k h^3: four edges at the distance h/2 from the middle, and the diagonals of the top and the bottom, as far
  // as the springs across hold them
  constexpr std::uint32_t levels = 20;
  const double root = 1.8751040687119611, bending = 4.0 / 3 * stiffness * std::pow(edge, 3);  // 1, N m^2
  const double theory = root * root / (2 * pi) * std::sqrt(bending / (mass / edge * std::pow(levels * edge, 4)));
  EXPECT_NEAR(first_frequency(levels, root, theory), theory, 0.01 * theory);
}

TEST(VoxelLattice, ABodyFallsAsGravityAndGroundDampingSay) {
  const Scene scene{Gravity{}, {}, {}, Damping{rate}, {}};
  const Body body = voxels({4, 4, 3}, ratio);
  const State start = resting(body, scene);
  const double t = 0.5, g = 9.81;
  const Answer a = simulate_ok(body, start, scene, fine, 5000);
  const double fallen = centre_of_mass(body, start.position).z - centre_of_mass(body, a.state.position).z;
  EXPECT_NEAR(fallen, g / rate * (t - (1 - std::exp(-rate * t)) / rate), 1e-7);
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
