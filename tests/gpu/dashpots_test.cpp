// Dashpots on the GPU: the same motion and records as on the CPU, for all forms of kernels.
#include "analysis/split_materials.hpp"
#include "gpu.hpp"
#include "physics/cases.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

using test::with_dashpots;

class GpuDashpots : public EachWayOnGpu {
 protected:
  /// The largest difference of positions to expect, m; observed ones are a fifth of it in float32.
  static double accuracy() { return single() ? 2e-5 : method() == Method::implicit ? 1e-7 : 1e-11; }

  /// Compares all results after 110 steps of a moving body in a scene without a floor, where rounding grows slowly.
  static void compare(const Body& body) {
    const Scene scene{Gravity{}, {}, {}, Damping{0.5}, Drag{0.1}};
    const State start = moving_state(body, scene, 11);
    Robot cpu(body, start), gpu(body, start), plain(body, start);
    const auto simulator = EachWayOnGpu::gpu(scene);
    simulate(*EachWayOnGpu::cpu(scene, 0), {&cpu}, 110, all_records);
    simulate(*simulator, {&gpu}, 110, all_records);
    simulate(*simulator, {&plain}, 110);
    ASSERT_EQ(cpu.answer.status, Status::ok) << cpu.answer.reason;
    ASSERT_EQ(gpu.answer.status, Status::ok) << gpu.answer.reason;
    EXPECT_EQ(distance(gpu.state, plain.state), 0) << "recording does not change the motion";
    const double near = accuracy();
    EXPECT_LT(distance(cpu.state, gpu.state), near);
    for (std::size_t i = 0; i < body.springs.size(); ++i) {
      const double of_force = 1e3 * near * (1 + cpu.answer.stress[i] + cpu.answer.peak_force[i]);
      ASSERT_NEAR(cpu.answer.stress[i], gpu.answer.stress[i], of_force) << i;
      ASSERT_NEAR(cpu.answer.tension[i], gpu.answer.tension[i], of_force) << i;
      ASSERT_NEAR(cpu.answer.peak_force[i], gpu.answer.peak_force[i], 10 * of_force) << i;
      ASSERT_NEAR(cpu.answer.muscle_work[i], gpu.answer.muscle_work[i], of_force) << i;
    }
    Body undamped = body;
    for (Material& material : undamped.materials) material.damping = 0;
    Robot other(undamped, start);
    simulate(*simulator, {&other}, 110);
    EXPECT_GT(distance(gpu.state, other.state), 20 * near) << "dashpots act";
  }
};

INSTANTIATE_TEST_SUITE_P(Gpu, GpuDashpots, all_ways(), named);

TEST_P(GpuDashpots, ActOnTheChip) { compare(with_dashpots(random_body(300, 20, 7))); }

TEST_P(GpuDashpots, ActWithSpringsInTheDevicesMemory) { compare(with_dashpots(random_body(1701, 14, 8))); }

TEST_P(GpuDashpots, ActBeyondTheChip) { compare(with_dashpots(random_body(20001, 8, 9))); }

TEST_P(GpuDashpots, OfMassesThatAllDiffer) {
  Body body = random_body(107, 9, 5);
  for (Material& material : body.materials) material.damping = 0.2;
  ASSERT_NE(split_materials(body), nullptr);
  compare(body);
}

TEST_P(GpuDashpots, ActTheSameInPiecesAndUnderSamples) {
  std::vector<Body> bodies{with_dashpots(test::random_body(107, 9, 5, 6)),
                           with_dashpots(test::random_body(1701, 14, 5, 8))};
  if (is_explicit(method())) bodies.push_back(with_dashpots(test::random_body(12001, 6, 5, 9)));
  test::expect_pieces_to_be_the_whole(gpu, bodies);
  test::expect_samples_to_change_nothing(gpu, bodies);
  test::expect_tallies_to_leave_the_motion_alone(gpu, bodies.front());
}

TEST_P(GpuDashpots, BesideComputedMaterials) {
  const Scene scene{Gravity{}, {}, {}, {}, {}};
  // on the chip, with springs in the device's memory, and beyond the chip
  for (const auto& [masses, neighbours] : {std::pair(107u, 9u), {1701u, 14u}, {20001u, 8u}}) {
    SCOPED_TRACE(masses);
    Body body = random_body(masses, neighbours, 5);
    for (Material& material : body.materials) material.damping = 0.2;
    ASSERT_NE(split_materials(body), nullptr) << "coefficients differ from spring to spring";
    body.materials[0].stiffness = 5011.7;  // no multiple of the code's unit
    const State start = moving_state(body, scene, 11);
    Robot cpu(body, start), gpu(body, start);
    simulate(*make_cpu_simulator(scene, way(Materials::computed), 0), {&cpu}, 110);
    simulate(*make_cuda_simulator(scene, way(Materials::computed)), {&gpu}, 110);
    ASSERT_EQ(gpu.answer.status, Status::ok) << gpu.answer.reason;
    EXPECT_LT(distance(cpu.state, gpu.state), accuracy());
  }
}

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
