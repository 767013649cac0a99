// The kernels for each size of body, and for unusual bodies, give the same results as the CPU.
#include "analysis/ground.hpp"
#include "gpu.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

class Forms : public ::testing::TestWithParam<Way> {
 protected:
  /// Simulates a body for 0.05 s on both devices, and compares positions and all recorded quantities.
  void compare(const Body& body, const State& start, unsigned largest_cluster = default_cluster) {
    const Scene scene = walking_scene();
    const Recording all{.stress = true, .work = true, .peak_force = true, .muscle_work = true, .tension = true};
    const bool single = std::get<Precision>(GetParam()) == Precision::float32;
    Robot cpu(body, start), gpu(body, start);
    simulate(*make_cpu_simulator(scene, stepping(GetParam()), 0), {&cpu}, 110, all);
    simulate(*make_cuda_simulator(scene, stepping(GetParam()), 0, default_portion, largest_cluster), {&gpu}, 110, all);
    EXPECT_EQ(cpu.answer.status, gpu.answer.status) << cpu.answer.reason << " / " << gpu.answer.reason;
    EXPECT_EQ(cpu.state.time, gpu.state.time);
    EXPECT_EQ(cpu.answer.spring_evaluations, gpu.answer.spring_evaluations);
    EXPECT_LE(distance(cpu.state, gpu.state), single ? 3e-3 : 3e-9);
    for (const auto list : SpringRecords::lists) ASSERT_EQ((cpu.answer.*list).size(), (gpu.answer.*list).size());
    for (std::size_t i = 0; i < cpu.answer.stress.size(); ++i) {
      const double near = (single ? 5e-2 : 5e-8) * (1 + cpu.answer.stress[i]);
      ASSERT_NEAR(cpu.answer.stress[i], gpu.answer.stress[i], near) << i;
      ASSERT_NEAR(cpu.answer.tension[i], gpu.answer.tension[i], near) << i;
      ASSERT_NEAR(cpu.answer.peak_force[i], gpu.answer.peak_force[i], 2 * near * (1 + cpu.answer.peak_force[i])) << i;
      ASSERT_NEAR(cpu.answer.muscle_work[i], gpu.answer.muscle_work[i], near) << i;
    }
    EXPECT_NEAR(cpu.answer.work, gpu.answer.work, (single ? 1e-3 : 1e-9) * (1e-3 + cpu.answer.work));
  }
  void compare(const Body& body, unsigned largest_cluster = default_cluster) {
    compare(body, moving_state(body, walking_scene(), 11), largest_cluster);
  }
  /// Does so for a body that does not land meanwhile: landing magnifies rounding errors.
  void compare_in_the_air(const Body& body, unsigned largest_cluster = default_cluster) {
    State start = moving_state(body, walking_scene(), 11);
    for (Vec3& position : start.position) position.z += 0.5;
    compare(body, start, largest_cluster);
  }
};

TEST_P(Forms, NoMasses) {
  EVODEVO_NEEDS_GPU();
  compare({});
}

TEST_P(Forms, OneMass) {
  EVODEVO_NEEDS_GPU();
  Body body;
  body.masses = {{{0, 0, 0}, 0.2}};
  compare(body);
}

TEST_P(Forms, CoincidentMassesFeelNoForce) {
  EVODEVO_NEEDS_GPU();
  Body body;
  body.materials = paper_materials();
  body.masses = {{{0, 0, 0}, 0.2}, {{0, 0, 0}, 0.2}};
  body.springs = {{0, 1, 0.1, 0}};
  compare(body, state_at_birth(body, walking_scene()));
}

TEST_P(Forms, MassesOfNoWeightStayWhereTheyAre) {
  EVODEVO_NEEDS_GPU();
  Body body = random_body(100, 10, 6);
  body.masses[3].mass = body.masses[50].mass = 0;
  State start = state_at_birth(body, walking_scene());
  compare(body, start);
}

TEST_P(Forms, MassesOfManySprings) {
  EVODEVO_NEEDS_GPU();
  Random random(3);
  Body body;
  body.materials = paper_materials();
  for (std::uint32_t i = 0; i < 700; ++i) {
    body.masses.push_back({random.vector(), 0.2});
    if (i > 0) body.springs.push_back({0, i, norm(body.masses[i].rest - body.masses[0].rest), i % 4});
  }
  body.masses[0].mass = 50;
  compare(body);
}

/// Materials with stiffnesses of 4,000 to 9,000 N/m, amplitudes up to 0.14 and all phases.
std::vector<Material> materials(int count) {
  std::vector<Material> all;
  for (int i = 0; i < count; ++i) {
    const double part = static_cast<double>(i) / count;
    all.push_back({4000 + 5000 * part, 0.14 * part, i % 2 == 0 ? 1.0 : 0.5, 2 * pi * part});
  }
  return all;
}

TEST_P(Forms, Materials16) {
  EVODEVO_NEEDS_GPU();
  compare(random_body(500, 25, 4, materials(16)));
}

TEST_P(Forms, Materials200) {
  EVODEVO_NEEDS_GPU();
  compare(random_body(500, 25, 4, materials(200)));
}

TEST_P(Forms, Materials5000ATableOfOneStep) {
  EVODEVO_NEEDS_GPU();
  compare(random_body(500, 25, 4, materials(5000)));
}

TEST_P(Forms, EverySpringItsOwnMaterial) {
  EVODEVO_NEEDS_GPU();
  const Body body = random_body(1000, 25, 4);
  compare(random_body(1000, 25, 4, materials(static_cast<int>(body.springs.size()))));
}

TEST_P(Forms, EverySpringItsOwnMaterialBeyondTheChip) {
  EVODEVO_NEEDS_GPU();
  const Body body = random_body(3000, 25, 4);
  compare(random_body(3000, 25, 4, materials(static_cast<int>(body.springs.size()))));
}

TEST_P(Forms, Chain) {
  EVODEVO_NEEDS_GPU();
  Body body;
  body.materials = paper_materials();
  for (std::uint32_t i = 0; i < 2000; ++i) {
    body.masses.push_back({{0.05 * i, 0, 0}, 0.2});
    if (i > 0) body.springs.push_back({i - 1, i, 0.05, i % 4});
  }
  compare(body);
}

/// Each method has its own kernels for each size.
class Sizes : public Forms {};

TEST_P(Sizes, Masses64) {
  EVODEVO_NEEDS_GPU();
  compare(random_body(64, 25, 5));
}

TEST_P(Sizes, Masses1000) {
  EVODEVO_NEEDS_GPU();
  compare(random_body(1000, 25, 5));
}

TEST_P(Sizes, Masses2000) {
  EVODEVO_NEEDS_GPU();
  compare(random_body(2000, 25, 5));
}

TEST_P(Sizes, Masses2000SpringsStreamed) {
  EVODEVO_NEEDS_GPU();
  compare(random_body(2000, 25, 5), 1);
}

TEST_P(Sizes, Masses4000OffsetsBeyond16Bits) {
  EVODEVO_NEEDS_GPU();
  compare(random_body(4000, 12, 5), 1);
}

TEST_P(Sizes, Masses8000SpringsStreamedInAClusterOfTwo) {
  EVODEVO_NEEDS_GPU();
  compare_in_the_air(random_body(8000, 12, 5), 2);
}

TEST_P(Sizes, Masses20000) {
  EVODEVO_NEEDS_GPU();
  compare(random_body(20000, 12, 5));
}

TEST_P(Sizes, Masses20000BeyondTheChip) {
  EVODEVO_NEEDS_GPU();
  compare(random_body(20000, 12, 5), 1);
}

TEST_P(Sizes, PartsWithoutCutSprings) {
  EVODEVO_NEEDS_GPU();
  compare_in_the_air(body_in_pieces(random_body(1000, 25, 6)));  // each piece is a part
}

// one method for each kind of kernel
INSTANTIATE_TEST_SUITE_P(Gpu, Forms,
                         ::testing::Combine(::testing::Values(Method::paper_euler, Method::implicit, Method::xpbd),
                                            ::testing::Values(Precision::float32, Precision::float64)),
                         [](const auto& test) { return name(test.param); });
INSTANTIATE_TEST_SUITE_P(Gpu, Sizes, all_ways(), [](const auto& test) { return name(test.param); });

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
