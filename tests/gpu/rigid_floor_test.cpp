// Rigid floors, with static friction and dashpots: the motion on the GPU agrees closely with that on the CPU. The
// bodies rest, slide or bounce a few times, so that rounding does not grow; each case checks that first.
#include <gmock/gmock.h>

#include "gpu.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

constexpr std::uint64_t steps = 300;
constexpr double dt = 0.0005;

Scene ground(double restitution, double roughness) {
  return {Gravity{9.81, 8}, Floor{.roughness = roughness, .restitution = restitution}, Friction{0.3, 0.6}, {}, {}};
}
Scene level(double restitution) { return ground(restitution, 0); }
Scene rough(double restitution) { return ground(restitution, 0.02); }

constexpr std::uint32_t different = 150;

/// Pairs of masses, each joined by a spring with a dashpot. Only the first ones differ, so that rounding decides in few
/// of them in which step a mass lands; the others are in the same places.
Body pairs(std::uint32_t count) {
  Body body;
  body.materials = {{200, 0, 0, 0, 0.3}};
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3 place{0.2 * (i % different % 15), 0.2 * (i % different / 15), 0};
    body.masses.push_back({place, 0.2});
    body.masses.push_back({place + Vec3{0.1, 0, 0}, 0.2});
    body.springs.push_back({2 * i, 2 * i + 1, 0.1, 0});
  }
  return body;
}

/// A pair of each kind rests, slides or falls.
State start_of_pairs(const Body& body, const Scene& scene) {
  State state = state_at_birth(body, scene);
  for (std::size_t i = 0; i < body.masses.size(); ++i) {
    const auto kind = static_cast<double>(i / 2 % different % 10);
    state.position[i].z = ground_height(scene, state.position[i]) + 0.0017 * kind;
    state.velocity[i] = {kind < 1 ? 0 : 0.1 * (kind - 4.5), kind < 1 ? 0 : 0.03 * kind, 0};
  }
  state.start_energy = total_energy(body, state, scene);
  return state;
}

/// A block that falls onto the ground and slides.
State start_of_block(const Body& body, const Scene& scene) {
  return test::thrown(body, scene, {0, 0, 0.0031}, {0.2, 0.1, 0});
}

/// The state after a run, and the number of steps in which each mass touched the ground.
struct End {
  State state;
  std::vector<double> contacts;
};

End end_of(Simulator& simulator, const Body& body, const State& start) {
  End end{start, {}};
  Task task{.body = &body, .state = &end.state, .dt = dt, .steps = steps, .sampled_at = {{steps, {.contacts = true}}}};
  simulator.run({&task, 1}, {});
  EXPECT_EQ(task.status, Status::ok) << task.reason;
  for (const Sample& sample : task.samples) end.contacts.assign(sample.contacts.begin(), sample.contacts.end());
  return end;
}

class GpuRigidFloor : public ::testing::TestWithParam<Method> {
 protected:
  /// Compares the ends of a run in single precision.
  static void compare(const Body& body, const State& start, const Scene& scene) {
    constexpr double near = 1e-4;  // m
    const Stepping single{GetParam(), Precision::float32};
    const End cpu = end_of(*make_cpu_simulator(scene, single, 0), body, start);
    const End exact = end_of(*make_cpu_simulator(scene, {GetParam(), Precision::float64}, 0), body, start);
    ASSERT_LT(distance(cpu.state, exact.state), near) << "rounding grows";
    EVODEVO_NEEDS_GPU();
    const End gpu = end_of(*make_cuda_simulator(scene, single), body, start);
    EXPECT_GT(distance(gpu.state, start), 0.01);
    EXPECT_LT(distance(cpu.state, gpu.state), near);
    EXPECT_THAT(gpu.contacts, ::testing::Pointwise(::testing::DoubleNear(0.05 * steps), cpu.contacts));
    EXPECT_GT(*std::max_element(gpu.contacts.begin(), gpu.contacts.end()), 0.5 * steps);
  }
};

INSTANTIATE_TEST_SUITE_P(Gpu, GpuRigidFloor, ::testing::ValuesIn(all_methods), named);

TEST_P(GpuRigidFloor, OnTheChip) {
  for (const Scene& scene : {level(0), level(0.5), rough(0), rough(0.5)}) {
    // in single precision, the solver of implicit leaves a residual on slopes
    if (GetParam() == Method::implicit && scene.floor->rough()) continue;
    const Body of_pairs = pairs(different), of_voxels = test::block(4, {2000, 0, 0, 0, 0.5});
    compare(of_pairs, start_of_pairs(of_pairs, scene), scene);
    compare(of_voxels, start_of_block(of_voxels, scene), scene);
  }
}

// the methods that are not explicit have one kernel for all sizes

TEST_P(GpuRigidFloor, WithSpringsInTheDevicesMemory) {
  if (!is_explicit(GetParam())) return;
  const Body body = test::block(11, {2000, 0, 0, 0, 0.5});
  for (const double e : {0.0, 0.5}) compare(body, start_of_block(body, rough(e)), rough(e));
}

TEST_P(GpuRigidFloor, BeyondTheChip) {
  if (!is_explicit(GetParam())) return;
  const Body body = pairs(43 * different);
  for (const double e : {0.0, 0.5}) compare(body, start_of_pairs(body, rough(e)), rough(e));
}

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
