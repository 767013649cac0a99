// The GPU computes what the CPU computes: to rounding, as long as rounding has not grown.
#include "gpu.hpp"

namespace evodevo::testing_gpu {
namespace {

/// How far a place may be off after 0.1 s, m; about ten times what is seen on an H200. Places of 1 m are 1e-7 m apart
/// in float32; a mass that touches the floor a step earlier or later multiplies what rounding has done until then.
double bound(Precision precision, bool contact) {
  if (precision == Precision::float32) return contact ? 3e-3 : 5e-5;
  return contact ? 3e-9 : 1e-13;
}

struct Case {
  const char* name;
  Scene scene;
};

std::vector<Case> cases() {
  return {{"nothing", {}},
          {"gravity", {Gravity{}, {}, {}, {}, {}}},
          {"floor", {Gravity{}, Floor{}, {}, {}, {}}},
          {"friction", {Gravity{}, Floor{}, Friction{}, {}, {}}},
          {"damping", {{}, {}, {}, Damping{}, {}}},
          {"drag", {{}, {}, {}, {}, Drag{0.5}}},
          {"everything", {Gravity{}, Floor{}, Friction{}, Damping{}, Drag{0.5}}}};
}

class Agreement : public testing::TestWithParam<std::tuple<Case, Precision>> {};

TEST_P(Agreement, PlacesAfter200Steps) {
  EVODEVO_NEEDS_GPU();
  const auto& [scene, precision] = GetParam();
  const Body body = random_body(300, 20, 7);
  const State start = moving_state(body, scene.scene, 8);
  Robot cpu(body, start), gpu(body, start);
  simulate(*make_cpu_simulator(scene.scene, stepping(precision), 1), {&cpu}, 200);
  simulate(*make_cuda_simulator(scene.scene, stepping(precision)), {&gpu}, 200);
  ASSERT_EQ(cpu.answer.status, Status::ok) << cpu.answer.reason;
  ASSERT_EQ(gpu.answer.status, Status::ok) << gpu.answer.reason;
  EXPECT_DOUBLE_EQ(gpu.state.time, 0.1);
  EXPECT_GT(distance(cpu.state, start), 0.01);
  const double off = distance(cpu.state, gpu.state);
  std::printf("           off by %.3g m\n", off);
  EXPECT_LT(off, bound(precision, scene.scene.floor.has_value()));
}

TEST_P(Agreement, StressAndWorkOf150Steps) {
  EVODEVO_NEEDS_GPU();
  const auto& [scene, precision] = GetParam();
  const Body body = random_body(300, 20, 9);
  const State start = moving_state(body, scene.scene, 10);
  Robot cpu(body, start), gpu(body, start), plain(body, start);
  const auto simulator = make_cuda_simulator(scene.scene, stepping(precision));
  simulate(*make_cpu_simulator(scene.scene, stepping(precision), 1), {&cpu}, 150, {.stress = true, .work = true});
  simulate(*simulator, {&gpu}, 150, {.stress = true, .work = true});
  simulate(*simulator, {&plain}, 150);
  // recording changes nothing
  EXPECT_EQ(distance(gpu.state, plain.state), 0);
  ASSERT_EQ(gpu.answer.stress.size(), body.springs.size());
  double largest = 0, mean = 0;
  for (std::size_t i = 0; i < body.springs.size(); ++i) {
    largest = std::max(largest, std::abs(gpu.answer.stress[i] - cpu.answer.stress[i]));
    mean += cpu.answer.stress[i] / static_cast<double>(body.springs.size());
  }
  std::printf("           stress off by %.3g N of %.3g N, work by %.3g J of %.3g J\n", largest, mean,
              std::abs(gpu.answer.work - cpu.answer.work), cpu.answer.work);
  EXPECT_GT(cpu.answer.work, 0);
  const double accuracy = bound(precision, scene.scene.floor.has_value());
  EXPECT_LT(largest, 1e4 * accuracy);
  EXPECT_NEAR(gpu.answer.work, cpu.answer.work, 10 * accuracy * cpu.answer.work);
}

INSTANTIATE_TEST_SUITE_P(Gpu, Agreement,
                         testing::Combine(testing::ValuesIn(cases()),
                                          testing::Values(Precision::float32, Precision::float64)),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param).name) + "_" + name(std::get<1>(test.param));
                         });

}  // namespace
}  // namespace evodevo::testing_gpu
