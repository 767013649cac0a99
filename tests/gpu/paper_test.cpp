// The paper's methods, whose speed is compared with that of ours, compute the same motion and record stress correctly.
#include <algorithm>
#include <numeric>

#include "analysis/ground.hpp"
#include "common/agreement.hpp"
#include "gpu.hpp"
#include "paper/paper_simulator.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

using namespace tools::bench;

constexpr double dt = 0.0005;  // time step, s

Robot simulated(const Body& body, const Scene& scene, std::uint64_t steps, Recording recording = {}) {
  Robot robot(body, state_at_birth(body, scene));
  simulate(*make_cuda_simulator(scene, single_precision), {&robot}, steps, recording);
  return robot;
}

/// Returns the recorded stress of one body after `steps` steps.
RecordedStress recorded(const Body& body, const PaperMethod& method, std::uint64_t steps) {
  PaperSimulator simulator({&body, 1}, 2, walking_scene(), dt, method);
  simulator.run(steps);
  return simulator.stress(0);
}

std::uint64_t sum(const std::vector<std::uint32_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

class PaperMotion : public ::testing::TestWithParam<std::tuple<MassMemory, SpringOrder>> {};

TEST_P(PaperMotion, IsOurs) {
  EVODEVO_NEEDS_GPU();
  const auto& [memory, order] = GetParam();
  const std::vector<Body> bodies{random_body(300, 20, 1), random_body(77, 10, 2)};
  const Scene swimming{{}, {}, {}, {}, Drag{0.5}};
  // the same tolerances as for the agreement of GPU and CPU
  for (const auto& [scene, bound] : {std::pair{walking_scene(), 3e-3}, std::pair{swimming, 5e-5}}) {
    PaperSimulator simulator(bodies, 3, scene, dt, {.memory = memory, .order = order});
    simulator.run(150);  // more steps than a table of materials holds
    simulator.restart();
    simulator.run(130);
    simulator.run(70);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const Robot ours = simulated(bodies[i], scene, 200);
      const State state = simulator.state(i);
      EXPECT_DOUBLE_EQ(state.time, 0.1);
      EXPECT_GT(distance(state, state_at_birth(bodies[i], scene)), 0.01);
      EXPECT_LT(distance(state, ours.state), bound);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Gpu, PaperMotion,
                         ::testing::Combine(::testing::Values(MassMemory::global, MassMemory::shared),
                                            ::testing::ValuesIn(tools::bench::spring_orders)));

class PaperStress : public OnGpu {};

TEST_F(PaperStress, AtomicSumsAreOurs) {
  const Body body = random_body(300, 20, 3);
  const RecordedStress stress = recorded(body, {.order = SpringOrder::spread, .stress = StressMethod::sums}, 150);
  const Robot ours = simulated(body, walking_scene(), 150, {.stress = true});
  for (std::size_t i = 0; i < body.springs.size(); ++i)
    ASSERT_NEAR(stress.sum[i] / 150, ours.answer.stress[i], 30) << i;  // 1e4 N/m times 3e-3 m
}

TEST_F(PaperStress, CountsTheExtremesOfAllSprings) {
  const Body body = random_body(300, 20, 4);
  const PaperMethod method{.order = SpringOrder::shuffled, .stress = StressMethod::extremes};
  const RecordedStress many = recorded(body, method, 50);
  EXPECT_EQ(sum(many.least), 50u);
  EXPECT_EQ(sum(many.most), 50u);
  // in the first steps, the most stressed spring is unambiguous
  const RecordedStress two = recorded(body, method, 2);
  const Robot ours = simulated(body, walking_scene(), 2, {.stress = true});
  const auto most = std::max_element(ours.answer.stress.begin(), ours.answer.stress.end());
  EXPECT_GE(two.most[static_cast<std::size_t>(most - ours.answer.stress.begin())], 1u);
}

TEST_F(PaperStress, EveryGroupOfSkipShiftCounts) {
  const Body body = random_body(300, 20, 5);
  const PaperMethod method{.threads = 128, .stress = StressMethod::skip_shift, .skip = 10};
  const RecordedStress stress = recorded(body, method, 105);
  EXPECT_EQ(sum(stress.least), 10u * 128);
  EXPECT_EQ(sum(stress.most), 10u * 128);
  EXPECT_LE(*std::max_element(stress.most.begin(), stress.most.end()), 10u);
}

TEST_F(PaperStress, SkipShiftFindsWhatIsStressed) {
  const Body body = random_body(500, 20, 6);
  const RecordedStress stress = recorded(body, {.stress = StressMethod::skip_shift, .skip = 1}, 2000);
  const Robot ours = simulated(body, walking_scene(), 2000, {.stress = true});
  const std::vector<double> most(stress.most.begin(), stress.most.end());
  // a random choice would find 0.02
  EXPECT_GT(tools::share_found(ours.answer.stress, most, 125), 0.3);
}

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
