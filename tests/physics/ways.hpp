// Tests that are run with each method and precision.
#pragma once

#include <gtest/gtest.h>

#include "support.hpp"

namespace evodevo::test {

inline auto ways(const std::vector<Method>& methods) {
  return ::testing::Combine(::testing::ValuesIn(methods), ::testing::Values(Precision::float32, Precision::float64));
}
inline auto all_ways() { return ways({all_methods.begin(), all_methods.end()}); }
inline auto explicit_ways() { return ways({explicit_methods.begin(), explicit_methods.end()}); }

/// Names the instances of tests whose parameter is a method, or a method and a precision.
inline constexpr auto named = [](const auto& instance) { return name_of(instance.param); };

class EachWay : public ::testing::TestWithParam<Arithmetic> {
 protected:
  static Method method() { return std::get<Method>(GetParam()); }
  static Precision precision() { return std::get<Precision>(GetParam()); }
  static bool single() { return precision() == Precision::float32; }
  static Steps stepping(double dt = 0.0005) { return {method(), precision(), dt}; }
  static double rounding() { return tolerance(precision()); }
  static SimulatorFactory factory(int threads = 1) {
    return [threads](const Scene& scene) { return make_cpu_simulator(scene, stepping(), threads); };
  }
};

/// Simulates one body as simulate() does, and expects that no check stops it.
inline Answer simulate_ok(const Body& body, const State& state, const Scene& scene, const Steps& stepping,
                          std::uint64_t steps, Recording recording = {}) {
  Answer answer = simulate(body, state, scene, stepping, steps, recording);
  EXPECT_EQ(answer.task.status, Status::ok) << answer.task.reason;
  return answer;
}

}  // namespace evodevo::test
