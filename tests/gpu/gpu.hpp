// What tests need a GPU for.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <string>

#include "bodies.hpp"
#include "cuda/cuda_simulator.hpp"

namespace evodevo::testing_gpu {

/// Skips a test where there is no GPU; with EVODEVO_REQUIRE_GPU=1 it fails.
#define EVODEVO_NEEDS_GPU()                                          \
  do {                                                               \
    const std::string missing = evodevo::why_cuda_is_unusable();     \
    if (missing.empty()) break;                                      \
    const char* required = std::getenv("EVODEVO_REQUIRE_GPU");       \
    if (required && std::string(required) == "1") FAIL() << missing; \
    GTEST_SKIP() << missing;                                         \
  } while (false)

/// The methods that the GPU knows.
inline constexpr Method methods[] = {Method::paper_euler};

inline Stepping stepping(Precision precision) { return {Method::paper_euler, precision}; }

inline const char* name(Precision precision) { return precision == Precision::float32 ? "float32" : "float64"; }

}  // namespace evodevo::testing_gpu
