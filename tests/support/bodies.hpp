// Comparison of bodies.
#pragma once

#include <gtest/gtest.h>

#include <tuple>

#include "evodevo/body.hpp"

namespace evodevo::testing {

/// Expects that both bodies have the same materials, masses and springs, as far as encodings set them.
inline void expect_same_body(const Body& one, const Body& other) {
  EXPECT_EQ(one.materials, other.materials);
  ASSERT_EQ(one.masses.size(), other.masses.size());
  for (std::size_t i = 0; i < one.masses.size(); ++i) {
    const Mass &a = one.masses[i], &b = other.masses[i];
    EXPECT_EQ(std::tie(a.rest, a.mass, a.material), std::tie(b.rest, b.mass, b.material)) << i;
  }
  ASSERT_EQ(one.springs.size(), other.springs.size());
  for (std::size_t i = 0; i < one.springs.size(); ++i) {
    const Spring &a = one.springs[i], &b = other.springs[i];
    EXPECT_EQ(std::tie(a.a, a.b, a.rest_length, a.material, a.stiffness_factor),
              std::tie(b.a, b.b, b.rest_length, b.material, b.stiffness_factor))
        << i;
  }
}

}  // namespace evodevo::testing
