// The GPU gives the same results as the CPU, up to rounding. The runs are so short that rounding errors do not grow
// much.
#include "analysis/stability.hpp"
#include "base/philox.hpp"
#include "core/skip_shift.hpp"
#include "gpu.hpp"
#include "physics/random_lives.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

/// Returns the tolerance of positions after 0.1 s, m; about ten times the deviations observed on an H200. Near 1 m, the
/// resolution of float32 is 1e-7 m. A mass that touches the floor one step earlier or later amplifies earlier rounding;
/// so does a mass that lands on a rigid floor or begins to slide in another step. With `implicit`, masses on a rigid
/// floor also have the residual of the solver, which depends on the rounding of its sums.
double bound(bool single, const Scene& scene) {
  if (!scene.floor) return single ? 5e-5 : 1e-13;
  const bool sticks = scene.friction && scene.friction->static_coefficient;
  if (single) return sticks || scene.floor->rigid() ? 1e-2 : 3e-3;
  return scene.floor->rigid() ? 5e-7 : 3e-9;
}

struct Case {
  const char* name;
  Scene scene;
};

std::vector<Case> cases() {
  return {
      {"nothing", {}},
      {"gravity", {Gravity{}, {}, {}, {}, {}}},
      {"slope", {Gravity{9.81, 12}, {}, {}, {}, {}}},
      {"floor", {Gravity{}, Floor{}, {}, {}, {}}},
      {"rough_ground", {Gravity{}, Floor{1e6, 0.05}, {}, {}, {}}},
      {"rigid_floor", {Gravity{}, Floor{.restitution = 0.3}, {}, {}, {}}},
      {"friction", {Gravity{}, Floor{}, Friction{}, {}, {}}},
      {"static_friction", {Gravity{}, Floor{}, Friction{0.4, 0.8}, {}, {}}},
      {"damping", {{}, {}, {}, Damping{}, {}}},
      {"drag", {{}, {}, {}, {}, Drag{0.5}}},
      {"everything", {Gravity{9.81, 12}, Floor{1e6, 0.05}, Friction{}, Damping{}, Drag{0.5}}},
      {"everything_on_rigid_ground",
       {Gravity{9.81, 12}, Floor{.roughness = 0.05, .restitution = 0.3}, Friction{0.4, 0.8}, Damping{}, Drag{0.5}}}};
}

class AgreementOfPlaces : public ::testing::TestWithParam<std::tuple<Case, test::Arithmetic>> {};

TEST_P(AgreementOfPlaces, After200Steps) {
  EVODEVO_NEEDS_GPU();
  const auto& [of_name, scene] = std::get<Case>(GetParam());
  const auto [method, precision] = std::get<test::Arithmetic>(GetParam());
  const Body body = random_body(300, 20, 7);
  const State start = moving_state(body, scene, 8);
  Robot cpu(body, start), gpu(body, start);
  simulate(*make_cpu_simulator(scene, {method, precision}, 1), {&cpu}, 200);
  simulate(*make_cuda_simulator(scene, {method, precision}), {&gpu}, 200);
  ASSERT_EQ(cpu.answer.status, Status::ok) << cpu.answer.reason;
  ASSERT_EQ(gpu.answer.status, Status::ok) << gpu.answer.reason;
  EXPECT_DOUBLE_EQ(gpu.state.time, 0.1);
  EXPECT_GT(distance(cpu.state, start), 0.01);
  EXPECT_LT(distance(cpu.state, gpu.state), bound(precision == Precision::float32, scene));
}

INSTANTIATE_TEST_SUITE_P(Gpu, AgreementOfPlaces, ::testing::Combine(::testing::ValuesIn(cases()), all_ways()),
                         [](const auto& test) {
                           return std::string(std::get<Case>(test.param).name) + "_" +
                                  test::name_of(std::get<test::Arithmetic>(test.param));
                         });

TEST(AgreementOfTallies, InFloat64) {
  EVODEVO_NEEDS_GPU();
  const Scene scene{Gravity{}, {}, {}, Damping{}, {}};
  const Body body = random_body(300, 20, 9);
  const Stepping stepping{Method::paper_euler, Precision::float64};
  const auto tallied = [&](Simulator& simulator) {
    State state = moving_state(body, scene, 10);
    Task task{.body = &body, .state = &state, .steps = 150};
    Rng random(philox, {1, 2, 3, 4});
    run_with_tallies(simulator, {&task, 1}, 10, [&](std::size_t, std::uint64_t) {
      return random_order(body.springs.size(), random);
    });
    EXPECT_EQ(task.status, Status::ok) << task.reason;
    return task.stress;
  };
  const std::vector<double> cpu = tallied(*make_cpu_simulator(scene, stepping, 1));
  EXPECT_GT(*std::max_element(cpu.begin(), cpu.end()), 5) << "of 15";
  EXPECT_EQ(tallied(*make_cuda_simulator(scene, stepping)), cpu);
}

/// Methods that are stable for larger steps than explicit methods. They are compared in float64, since in float32
/// contact soon makes the two motions differ.
class AgreementOfLargeSteps : public ::testing::TestWithParam<Method> {};

TEST_P(AgreementOfLargeSteps, After100Steps) {
  EVODEVO_NEEDS_GPU();
  const Scene scene = walking_scene();
  const Body body = random_body(300, 20, 7);
  State start = state_at_birth(body, scene);
  const double factor = GetParam() == Method::implicit ? 20 : 3;
  const Stepping stepping{GetParam(), Precision::float64};
  Robot cpu(body, start), gpu(body, start);
  cpu.dt = gpu.dt = factor * largest_dt(body, start.position, Method::paper_euler);
  simulate(*make_cpu_simulator(scene, stepping, 1), {&cpu}, 100);
  simulate(*make_cuda_simulator(scene, stepping), {&gpu}, 100);
  ASSERT_EQ(cpu.answer.status, Status::ok) << cpu.answer.reason;
  ASSERT_EQ(gpu.answer.status, Status::ok) << gpu.answer.reason;
  EXPECT_GT(distance(cpu.state, start), 0.01);
  EXPECT_LT(distance(cpu.state, gpu.state), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Gpu, AgreementOfLargeSteps, ::testing::Values(Method::implicit, Method::xpbd), named);

class AgreementOfRandomLives : public EachWayOnGpu {};

INSTANTIATE_TEST_SUITE_P(Gpu, AgreementOfRandomLives, all_ways(), named);

TEST_P(AgreementOfRandomLives, In16RandomScenes) {
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    SCOPED_TRACE("random_scene(" + std::to_string(seed) + ")");
    const Scene scene = test::random_scene(seed);
    const std::vector<test::Life> lives = test::random_lives(scene, seed, 64);
    const std::vector<test::Answer> on_cpu = test::simulate(*cpu(scene, 0), lives);
    const std::vector<test::Answer> on_gpu = test::simulate(*gpu(scene), lives);
    for (std::size_t i = 0; i < lives.size(); ++i) {
      SCOPED_TRACE("the life of seed " + std::to_string(lives[i].seed));
      EXPECT_EQ(on_gpu[i].task.status, Status::ok) << on_gpu[i].task.reason;
      // about ten times the deviations observed
      EXPECT_LT(distance(on_cpu[i].state, on_gpu[i].state), single() ? 1e-2 : 1e-9);
    }
  }
}

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
