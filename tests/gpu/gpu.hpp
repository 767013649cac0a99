// Helpers for tests that need a GPU.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>
#include <string>
#include <tuple>

#include "bodies.hpp"
#include "cpu/simulator.hpp"
#include "cuda/runtime/cuda_simulator.hpp"

namespace evodevo::testing_gpu {

/// Skips a test if there is no usable GPU; with EVODEVO_REQUIRE_GPU=1, the test fails instead.
#define EVODEVO_NEEDS_GPU()                                          \
  do {                                                               \
    const std::string missing = evodevo::why_cuda_is_unusable();     \
    if (missing.empty()) break;                                      \
    const char* required = std::getenv("EVODEVO_REQUIRE_GPU");       \
    if (required && std::string(required) == "1") FAIL() << missing; \
    GTEST_SKIP() << missing;                                         \
  } while (false)

/// A method and a precision.
using Way = std::tuple<Method, Precision>;

inline Stepping stepping(Precision precision) { return {Method::paper_euler, precision}; }
inline Stepping stepping(const Way& way) { return {std::get<Method>(way), std::get<Precision>(way)}; }

inline const char* name(Precision precision) { return precision == Precision::float32 ? "float32" : "float64"; }

/// Returns the name for tests, which has only letters, digits and underscores.
inline std::string name(const Way& way) {
  std::string text = std::string(evodevo::name(std::get<Method>(way))) + "_" + name(std::get<Precision>(way));
  std::replace(text.begin(), text.end(), '-', '_');
  return text;
}

inline constexpr std::array all_methods = {Method::paper_euler, Method::symplectic_euler, Method::velocity_verlet,
                                           Method::rk4,         Method::implicit,         Method::xpbd};

inline auto explicit_ways() {
  return ::testing::Combine(::testing::ValuesIn(all_methods.begin(), all_methods.begin() + 4),
                            ::testing::Values(Precision::float32, Precision::float64));
}

inline auto all_ways() {
  return ::testing::Combine(::testing::ValuesIn(all_methods),
                            ::testing::Values(Precision::float32, Precision::float64));
}

}  // namespace evodevo::testing_gpu
