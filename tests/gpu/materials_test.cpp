// Springs whose materials are computed from codes move as on the CPU, both in bodies that stay on the chip and in
// bodies that do not fit there. So do springs whose stiffness differs from that of their material by a factor.
#include "analysis/computed_materials.hpp"
#include "analysis/split_materials.hpp"
#include "gpu.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

/// `count` materials of 4,000 to 9,000 N/m, with amplitudes and frequencies of either sign and any phase.
std::vector<Material> random_materials(std::size_t count) {
  Random random(12);
  std::vector<Material> all;
  for (std::size_t i = 0; i < count; ++i)
    all.push_back({6500 + 2500 * random.between(-1, 1), 0.14 * random.between(-1, 1), 2 * random.between(-1, 1),
                   4 * pi * random.between(-1, 1)});
  return all;
}

/// A random body in which each spring has a material of its own.
Body varied_body(std::uint32_t masses, std::uint32_t neighbours) {
  Body body = random_body(masses, neighbours, 4);
  body.materials = random_materials(body.springs.size());
  for (std::uint32_t i = 0; i < body.springs.size(); ++i) body.springs[i].material = i;
  return body;
}

class ComputedMaterials : public EachWayOnGpu {
 protected:
  /// Simulates a body for 0.055 s on both devices, and compares positions and all recorded quantities.
  static void compare(const Body& body, const Scene& scene) {
    const State start = moving_state(body, scene, 11);
    Robot cpu(body, start), gpu(body, start), plain(body, start);
    const auto simulator = make_cuda_simulator(scene, way(Materials::computed));
    simulate(*make_cpu_simulator(scene, way(Materials::computed), 0), {&cpu}, 110, all_records);
    simulate(*simulator, {&gpu}, 110, all_records);
    simulate(*simulator, {&plain}, 110);
    ASSERT_EQ(cpu.answer.status, Status::ok) << cpu.answer.reason;
    // In float32, materials are codes, and recording does not change the motion. In float64, materials are in tables,
    // and kernels with recording round differently.
    if (single()) {
      EXPECT_EQ(distance(gpu.state, plain.state), 0);
    }
    expect_agreement(cpu, gpu, single() ? 3e-3 : 3e-9, single() ? 5e-2 : 5e-8, single() ? 1e-3 : 1e-9);
  }
};

INSTANTIATE_TEST_SUITE_P(Gpu, ComputedMaterials, all_ways(), named);

TEST_P(ComputedMaterials, ActInAllForcesAndMayBeFewAndNeedNoMuscles) {
  compare(varied_body(300, 20), {Gravity{9.81, 12}, Floor{1e6, 0.05}, Friction{}, Damping{}, Drag{0.5}});
  compare(random_body(300, 20, 4), walking_scene());
  compare(test::passive(varied_body(300, 20)), walking_scene());
}

TEST_P(ComputedMaterials, ActInEachFormOfKernels) {
  // on the chip, with springs streamed, with offsets beyond 16 bits, and beyond the chip
  for (const auto& [masses, neighbours] : {std::pair(1000u, 25u), {2000u, 25u}, {4000u, 12u}, {20000u, 12u}}) {
    SCOPED_TRACE(masses);
    compare(varied_body(masses, neighbours), walking_scene());
  }
}

/// Springs between masses that never move: at any time since birth, their forces must be those of the materials in
/// their codes.
class ComputedForces : public ::testing::TestWithParam<double> {};

TEST_P(ComputedForces, AreThoseOfTheCodes) {
  EVODEVO_NEEDS_GPU();
  Body body = varied_body(300, 20);
  for (Mass& mass : body.masses) mass.mass = 0;
  const Scene nothing;
  State state = state_at_birth(body, nothing);
  state.time = GetParam();
  state.start_energy = total_energy(body, state, nothing);
  Robot run(body, state);
  simulate(*make_cuda_simulator(nothing, {.materials = Materials::computed}), {&run}, 1, all_records);
  ASSERT_EQ(run.answer.status, Status::ok) << run.answer.reason;
  const std::vector<Material> materials = simulated_materials(body, Materials::computed);
  // the clock has an error of 2^-33 periods, multiplied by up to 1,020, the largest frequency; the angle is rounded
  // twice, and the sine has an error of up to 2^-20.5
  const double sine = 2 * pi * (1020 * 0x1p-33 + 0x1p-25) + pi * 0x1p-24 + 0x1p-20;
  const double rounding = 8 * 0x1p-24;  // rounding of positions, and of products and sums in the force
  for (std::size_t i = 0; i < body.springs.size(); ++i) {
    const Spring& spring = body.springs[i];
    const Material& m = materials[spring.material];
    const double distance = norm(state.position[spring.b] - state.position[spring.a]);
    const double length = spring.rest_length * m.relative_length(state.time);
    const double tension = m.stiffness * (distance - length);
    const double muscle = m.stiffness * spring.rest_length * m.amplitude;
    const double accuracy = muscle * sine + m.stiffness * (1 + distance + length) * rounding;
    EXPECT_NEAR(run.answer.tension[i], tension, accuracy) << i;
    const double speed = 2 * pi * m.frequency * m.amplitude * spring.rest_length;  // largest speed, m/s
    const double rate = speed * std::cos(2 * pi * m.frequency * state.time + m.phase);
    EXPECT_NEAR(run.answer.muscle_work[i], run.dt * std::max(0.0, -tension * rate),
                run.dt * (speed * accuracy + std::abs(tension) * speed * (sine + rounding)))
        << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Gpu, ComputedForces, ::testing::Values(0.0, 0.25, 12.3456, 5e4), [](const auto& test) {
  return "From" + std::to_string(static_cast<int>(test.param * 100)) + "Hundredths";
});

class StiffnessFactors : public EachWayOnGpu {
 protected:
  static void compare(std::uint32_t masses, Materials materials) {
    Body body = random_body(masses, 12, 4);
    for (std::size_t i = 0; i < body.springs.size(); ++i)
      body.springs[i].stiffness_factor = 0.5 + static_cast<double>(i % 1021) / 1020;
    const auto plain = split_materials(body);
    const Scene scene = walking_scene();
    const State start = moving_state(body, scene, 11);
    Robot with(body, start), without(*plain, start);
    const auto simulator = make_cuda_simulator(scene, way(materials));
    for (Robot* robot : {&with, &without}) simulate(*simulator, {robot}, 110, {.stress = true, .tension = true});
    ASSERT_EQ(with.answer.status, Status::ok) << with.answer.reason;
    expect_same_bits(with, without);
    for (Spring& spring : body.springs) spring.stiffness_factor = 1;
    Robot unchanged(body, start);
    simulate(*simulator, {&unchanged}, 110);
    EXPECT_GT(distance(with.state, unchanged.state), 0);
  }
};

INSTANTIATE_TEST_SUITE_P(Gpu, StiffnessFactors, all_ways(), named);

TEST_P(StiffnessFactors, ActOnTheChip) {
  for (const Materials materials : {Materials::table, Materials::computed}) compare(300, materials);
}

TEST_P(StiffnessFactors, ActBeyondTheChip) { compare(20000, Materials::table); }

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
