// The simulator compared with a simple second implementation, on every instruction set of this processor.
#include <hwy/targets.h>

#include <cmath>
#include <tuple>

#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "ways.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// Limits simulators that are created during its lifetime to one instruction set.
class OnlyTarget {
 public:
  explicit OnlyTarget(std::int64_t target) { hwy::SetSupportedTargetsForTest(target); }
  ~OnlyTarget() { hwy::SetSupportedTargetsForTest(0); }
};

struct Set {
  std::int64_t target;
  const char* name;    ///< part of the names of tests
  const char* device;  ///< name in the text of Simulator::device()
};

constexpr Set avx512{HWY_AVX3, "avx512", "cpu, AVX-512"};
constexpr Set avx2{HWY_AVX2, "avx2", "cpu, AVX2"};
constexpr Set sse4{HWY_SSE4, "sse4", "cpu, SSE4"};
constexpr Set scalar{HWY_SCALAR, "scalar", "cpu, no vectors"};

bool is_there(const Set& set) { return set.target == HWY_SCALAR || (hwy::SupportedTargets() & set.target) != 0; }

using Case = std::tuple<Set, Precision, std::uint32_t>;  // the integer is the number of materials

std::string name_of_case(const ::testing::TestParamInfo<Case>& info) {
  const auto& [set, precision, materials] = info.param;
  return std::string(set.name) + "_" + name_of(precision) + "_" + std::to_string(materials);
}

class AgainstReference : public ::testing::TestWithParam<Case> {};

// sixteen materials fit into registers, forty do not
INSTANTIATE_TEST_SUITE_P(Sets, AgainstReference,
                         ::testing::Combine(::testing::Values(avx512, avx2, sse4, scalar),
                                            ::testing::Values(Precision::float32, Precision::float64),
                                            ::testing::Values(16u, 40u)),
                         name_of_case);

/// Returns a state in which `body` is at its position at birth, rotates and moves downwards.
State turning(const Body& body, const Scene& scene) {
  State state = state_at_birth(body, scene);
  for (std::size_t i = 0; i < state.velocity.size(); ++i)
    state.velocity[i] = {-0.5 * state.position[i].y, 0.5 * state.position[i].x, -0.2};
  state.time = 0.15;
  state.start_energy = total_energy(body, state, scene);
  return state;
}

TEST_P(AgainstReference, RandomBodiesInAllForcesAgreeToRounding) {
  const auto& [set, precision, materials] = GetParam();
  if (!is_there(set)) GTEST_SKIP() << "this processor has no " << set.name;
  const OnlyTarget only(set.target);
  const Steps stepping{Method::paper_euler, precision, 0.0005};
  ASSERT_EQ(make_cpu_simulator({}, stepping, 1)->device(), set.device);
  const bool single = precision == Precision::float32;
  for (const std::uint32_t masses : {37u, 150u}) {
    const Body body = random_body(masses, 9, materials, masses);
    for (const Scene& scene : {Scene{}, walking_scene(), full_scene(), Scene{{}, {}, {}, {}, Drag{0.5}}}) {
      const std::uint64_t steps = 250;
      const State start = turning(body, scene);
      const Answer a = simulate_ok(body, start, scene, stepping, steps, {.stress = true, .work = true});
      EXPECT_EQ(a.task.spring_evaluations, steps * body.springs.size());
      const Reference r = reference(body, start, scene, stepping.dt, steps);
      ASSERT_GT(largest_difference(start, r.state), 0.02);
      // rounding changes the time of a contact, which the stiff floor amplifies
      const double error = single ? (scene.floor ? 3e-3 : 2e-5) : (scene.floor ? 2e-11 : 1e-12);
      EXPECT_LT(largest_difference(a.state, r.state), error);
      EXPECT_NEAR(a.task.work, r.work, (single ? 2e-3 : 1e-10) * r.work);
      for (std::size_t i = 0; i < body.springs.size(); ++i)
        ASSERT_NEAR(a.task.stress[i], r.stress[i], single ? (scene.floor ? 1 : 0.02) : 1e-7) << "spring " << i;
    }
  }
}

class InstructionSets : public EachWay {
 protected:
  /// Simulates a body in a scene with all forces, with one instruction set.
  static Answer simulated_with(const Set& set, std::uint64_t steps) {
    const OnlyTarget only(set.target);
    const Body body = random_body(150, 12, 14, 8);
    return simulate(body, state_at_birth(body, full_scene()), full_scene(), stepping(), steps,
                    {.stress = true, .work = true});
  }
};

INSTANTIATE_TEST_SUITE_P(Methods, InstructionSets, all_ways(), named);

TEST_P(InstructionSets, ThatFuseMultiplyAndAddAgreeToTheBit) {
  if (method() == Method::implicit) GTEST_SKIP() << "its scalar products depend on the width of vectors";
  if (!is_there(avx512) || !is_there(avx2)) GTEST_SKIP() << "this processor has no AVX-512";
  const Answer a = simulated_with(avx512, 1000), b = simulated_with(avx2, 1000);
  EXPECT_TRUE(same_bits(a.state, b.state));
  EXPECT_EQ(a.task.stress, b.task.stress);
  EXPECT_EQ(a.task.work, b.task.work);
}

TEST_P(InstructionSets, AllAgreeToRounding) {
  const double residual = method() == Method::implicit ? 1e-6 : 0;  // of the conjugate gradients
  const double error = (single() ? 1e-4 : 1e-10) + residual;
  const Answer plain = simulated_with(scalar, 200);
  for (const Set& set : {avx512, avx2, sse4}) {
    if (!is_there(set)) continue;
    const Answer a = simulated_with(set, 200);
    ASSERT_EQ(a.task.status, Status::ok) << a.task.reason;
    EXPECT_LT(largest_difference(a.state, plain.state), error) << set.name;
    EXPECT_NEAR(a.task.work, plain.task.work, 100 * error * plain.task.work) << set.name;
    for (std::size_t i = 0; i < a.task.stress.size(); ++i)
      ASSERT_NEAR(a.task.stress[i], plain.task.stress[i], 1e4 * error) << set.name << ", spring " << i;
  }
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
