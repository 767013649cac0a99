// The GPU gives the same results as the CPU, up to rounding. The runs are so short that rounding errors do not grow
// much.
#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "analysis/stability.hpp"
#include "base/philox.hpp"
#include "core/skip_shift.hpp"
#include "gpu.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

/// Returns the tolerance of positions after 0.1 s, m; about ten times the deviations observed on an H200. Near 1 m, the
/// resolution of float32 is 1e-7 m. A mass that touches the floor one step earlier or later amplifies earlier rounding;
/// so does a mass that lands on a rigid floor or begins to slide in another step. With `implicit`, masses on a rigid
/// floor also have the residual of the solver, which depends on the rounding of its sums.
double bound(const Way& way, const Scene& scene) {
  const bool single = std::get<Precision>(way) == Precision::float32;
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

class AgreementOfPlaces : public ::testing::TestWithParam<std::tuple<Case, Way>> {};

TEST_P(AgreementOfPlaces, After200Steps) {
  EVODEVO_NEEDS_GPU();
  const auto& [scene, way] = GetParam();
  const Body body = random_body(300, 20, 7);
  const State start = moving_state(body, scene.scene, 8);
  Robot cpu(body, start), gpu(body, start);
  simulate(*make_cpu_simulator(scene.scene, stepping(way), 1), {&cpu}, 200);
  simulate(*make_cuda_simulator(scene.scene, stepping(way)), {&gpu}, 200);
  ASSERT_EQ(cpu.answer.status, Status::ok) << cpu.answer.reason;
  ASSERT_EQ(gpu.answer.status, Status::ok) << gpu.answer.reason;
  EXPECT_DOUBLE_EQ(gpu.state.time, 0.1);
  EXPECT_GT(distance(cpu.state, start), 0.01);
  const double off = distance(cpu.state, gpu.state);
  std::printf("           off by %.3g m\n", off);
  EXPECT_LT(off, bound(way, scene.scene));
}

INSTANTIATE_TEST_SUITE_P(Gpu, AgreementOfPlaces, ::testing::Combine(::testing::ValuesIn(cases()), all_ways()),
                         [](const auto& test) {
                           return std::string(std::get<Case>(test.param).name) + "_" + name(std::get<Way>(test.param));
                         });

class AgreementOfRecords : public ::testing::TestWithParam<Way> {};

TEST_P(AgreementOfRecords, StressAndWorkOf150Steps) {
  EVODEVO_NEEDS_GPU();
  const Way way = GetParam();
  const Scene scene{Gravity{}, Floor{}, Friction{}, Damping{}, Drag{0.5}};
  const Body body = random_body(300, 20, 9);
  const State start = moving_state(body, scene, 10);
  Robot cpu(body, start), gpu(body, start), plain(body, start);
  const auto simulator = make_cuda_simulator(scene, stepping(way));
  const Recording all{.stress = true, .work = true, .peak_force = true, .muscle_work = true, .tension = true};
  simulate(*make_cpu_simulator(scene, stepping(way), 1), {&cpu}, 150, all);
  simulate(*simulator, {&gpu}, 150, all);
  simulate(*simulator, {&plain}, 150);
  // recording does not change the motion
  EXPECT_EQ(distance(gpu.state, plain.state), 0);
  for (const auto list : SpringRecords::lists) ASSERT_EQ((gpu.answer.*list).size(), body.springs.size());
  double largest = 0, largest_peak = 0, mean = 0, sum = 0;
  for (std::size_t i = 0; i < body.springs.size(); ++i) {
    largest = std::max({largest, std::abs(gpu.answer.stress[i] - cpu.answer.stress[i]),
                        std::abs(gpu.answer.tension[i] - cpu.answer.tension[i])});
    largest_peak = std::max(largest_peak, std::abs(gpu.answer.peak_force[i] - cpu.answer.peak_force[i]));
    mean += cpu.answer.stress[i] / static_cast<double>(body.springs.size());
    sum += gpu.answer.muscle_work[i];
    EXPECT_LE(std::abs(gpu.answer.tension[i]), gpu.answer.stress[i] * 1.0001) << i;
    EXPECT_GE(gpu.answer.peak_force[i] * 1.0001, gpu.answer.stress[i]) << i;
  }
  std::printf("           stress off by %.3g N of %.3g N, work by %.3g J of %.3g J\n", largest, mean,
              std::abs(gpu.answer.work - cpu.answer.work), cpu.answer.work);
  EXPECT_GT(cpu.answer.work, 0);
  const double accuracy = bound(way, scene);
  // tolerances, N; observed deviations are at most 0.2 in float32 and 6e-9 in float64, except where one contact begins
  // a step later
  const bool late_touch = way == Way{Method::symplectic_euler, Precision::float64};
  EXPECT_LT(largest, std::get<Precision>(way) == Precision::float32 ? 3 : late_touch ? 1e-3 : 3e-5);
  EXPECT_LT(largest_peak, std::get<Precision>(way) == Precision::float32 ? 60 : 1e-1);
  EXPECT_NEAR(gpu.answer.work, cpu.answer.work, 10 * accuracy * cpu.answer.work);
  EXPECT_NEAR(sum, gpu.answer.work, (std::get<Precision>(way) == Precision::float32 ? 1e-5 : 1e-12) * sum);
}

INSTANTIATE_TEST_SUITE_P(Gpu, AgreementOfRecords, all_ways(), [](const auto& test) { return name(test.param); });

TEST(AgreementOfTallies, InFloat64) {
  EVODEVO_NEEDS_GPU();
  const Scene scene{Gravity{}, {}, {}, Damping{}, {}};
  const Body body = random_body(300, 20, 9);
  const Stepping stepping{Method::paper_euler, Precision::float64};
  const State start = moving_state(body, scene, 10);
  const auto tallied = [&](Simulator& simulator) {
    State state = start;
    Task task{.body = &body, .state = &state, .steps = 150};
    Rng random(philox, {1, 2, 3, 4});
    run_with_tallies(simulator, {&task, 1}, 10, {&random, 1});
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
  const double off = distance(cpu.state, gpu.state);
  std::printf("           off by %.3g m\n", off);
  EXPECT_LT(off, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Gpu, AgreementOfLargeSteps, ::testing::Values(Method::implicit, Method::xpbd),
                         [](const auto& test) { return std::string(evodevo::name(test.param)); });

/// A thrown mass, whose positions must equal the closed-form solution of each method's steps.
class FreeFall : public ::testing::TestWithParam<Way> {};

TEST_P(FreeFall, IsThatOfTheMethod) {
  EVODEVO_NEEDS_GPU();
  const Scene scene{Gravity{}, {}, {}, {}, {}};
  Body body;
  body.masses = {{{0, 0, 0}, 0.2}};
  State start = state_at_birth(body, scene);
  start.position[0].z = 4;
  start.velocity[0] = {3, 0, 4};
  start.start_energy = total_energy(body, start, scene);
  Robot run(body, start);
  simulate(*make_cuda_simulator(scene, stepping(GetParam())), {&run}, 1000);
  const auto [method, precision] = GetParam();
  // methods with x <- x + dt v and the new v fall g t dt / 2 further than g t^2 / 2; the other methods are exact
  const double t = 0.5, further = method == Method::velocity_verlet || method == Method::rk4 ? 0 : 0.0005;
  const double rounding = precision == Precision::float32 ? 1e-4 : 1e-12;
  EXPECT_NEAR(run.state.position[0].z, 4 + 4 * t - 9.81 * t * (t + further) / 2, rounding);
  EXPECT_NEAR(run.state.position[0].x, 3 * t, rounding);
}

INSTANTIATE_TEST_SUITE_P(Gpu, FreeFall, all_ways(), [](const auto& test) { return name(test.param); });

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
