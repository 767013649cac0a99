// Springs whose stiffness differs from that of their material by a factor move as if they had a material with this
// stiffness, both in bodies that stay on the chip and in bodies that do not fit there.
#include "analysis/split_materials.hpp"
#include "gpu.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

class StiffnessFactors : public ::testing::TestWithParam<Way> {
 protected:
  static void compare(std::uint32_t masses, Materials materials) {
    Body body = random_body(masses, 12, 4);
    for (std::size_t i = 0; i < body.springs.size(); ++i)
      body.springs[i].stiffness_factor = 0.5 + static_cast<double>(i % 1021) / 1020;
    const auto plain = split_materials(body);
    const Scene scene = walking_scene();
    const State start = moving_state(body, scene, 11);
    Robot with(body, start), without(*plain, start);
    const auto [method, precision] = GetParam();
    const auto simulator = make_cuda_simulator(scene, {method, precision, materials});
    for (Robot* robot : {&with, &without}) simulate(*simulator, {robot}, 110, {.stress = true, .tension = true});
    ASSERT_EQ(with.answer.status, Status::ok) << with.answer.reason;
    EXPECT_EQ(distance(with.state, without.state), 0);
    EXPECT_EQ(with.answer.stress, without.answer.stress);
    EXPECT_EQ(with.answer.tension, without.answer.tension);
    for (Spring& spring : body.springs) spring.stiffness_factor = 1;
    Robot unchanged(body, start);
    simulate(*simulator, {&unchanged}, 110);
    EXPECT_GT(distance(with.state, unchanged.state), 0);
  }
};

TEST_P(StiffnessFactors, OnTheChip) {
  EVODEVO_NEEDS_GPU();
  compare(300, Materials::table);
}

TEST_P(StiffnessFactors, OnTheChipWithComputedMaterials) {
  EVODEVO_NEEDS_GPU();
  compare(300, Materials::computed);
}

TEST_P(StiffnessFactors, BeyondTheChip) {
  EVODEVO_NEEDS_GPU();
  compare(20000, Materials::table);
}

INSTANTIATE_TEST_SUITE_P(Gpu, StiffnessFactors, all_ways(), [](const auto& test) { return name(test.param); });

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
