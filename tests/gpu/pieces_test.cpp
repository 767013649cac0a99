// On the GPU, a simulation in several pieces equals the simulation as a whole, and the guard makes the same decisions
// as on the CPU.
#include "physics/pieces.hpp"

#include "gpu.hpp"
#include "physics/guard_cases.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

class GpuRuns : public ::testing::TestWithParam<Way> {
 protected:
  static Method method() { return std::get<Method>(GetParam()); }
  static test::SimulatorFactory factory() {
    return [](const Scene& scene) { return make_cuda_simulator(scene, stepping(GetParam())); };
  }
};

INSTANTIATE_TEST_SUITE_P(Gpu, GpuRuns, all_ways(), [](const auto& test) { return name(test.param); });

TEST_P(GpuRuns, InPiecesEndInTheBitsOfTheWhole) {
  EVODEVO_NEEDS_GPU();
  // a body on the chip, one with its springs in the device's memory, and one completely in the device's memory
  std::vector<Body> bodies{test::random_body(107, 9, 5, 6), test::random_body(41, 6, 23, 7), test::single_mass(0.2),
                           test::random_body(1701, 14, 5, 8)};
  if (is_explicit(method())) bodies.push_back(test::random_body(12001, 6, 5, 9));
  test::expect_pieces_to_be_the_whole(factory(), bodies);
}

TEST_P(GpuRuns, InPiecesBetweenTalliesToo) {
  EVODEVO_NEEDS_GPU();
  test::expect_tallies_to_leave_the_motion_alone(factory(), test::random_body(41, 6, 5, 7));
}

TEST_P(GpuRuns, InPiecesAreNotCheckedWhereTheyMeet) {
  EVODEVO_NEEDS_GPU();
  test::expect_no_check_between_pieces(factory());
}

TEST_P(GpuRuns, InPiecesDivergeWhereTheWholeDoes) {
  EVODEVO_NEEDS_GPU();
  if (is_explicit(method())) test::expect_one_verdict(factory(), method());
}

TEST_P(GpuRuns, LetResonanceLive) {
  EVODEVO_NEEDS_GPU();
  test::expect_resonance_to_live(factory(), method());
}

TEST_P(GpuRuns, HaveOneBoundForOneRunAndForSeveral) {
  EVODEVO_NEEDS_GPU();
  test::expect_one_bound(factory());
}

TEST_P(GpuRuns, EndWhatTheFloorPumpsUp) {
  EVODEVO_NEEDS_GPU();
  if (is_explicit(method()) && method() != Method::rk4) test::expect_pumped_bodies_to_end(factory());
}

TEST(GpuRunsOfComputedMaterials, InPiecesEndInTheBitsOfTheWhole) {
  EVODEVO_NEEDS_GPU();
  for (const Method method : {Method::paper_euler, Method::rk4})
    test::expect_pieces_to_be_the_whole(
        [&](const Scene& scene) {
          return make_cuda_simulator(scene, {method, Precision::float32, Materials::computed});
        },
        {test::random_body(107, 9, 23, 6), test::random_body(1701, 14, 5, 8)});
}

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
