// Comparison of runs.
#pragma once

#include <gtest/gtest.h>

#include "evolution/archive/archive.hpp"

namespace evodevo::testing {

/// Expects that the individuals of both runs have the same genes, ancestry, results and recorded lives, and that the
/// generations have the same statistics, except for the wall time.
inline void expect_same_runs(const Archive& a, const Archive& b) {
  const auto generations_a = a.generations(), generations_b = b.generations();
  ASSERT_EQ(generations_a.size(), generations_b.size());
  for (std::size_t i = 0; i < generations_a.size(); ++i) {
    EXPECT_EQ(generations_a[i].evaluations, generations_b[i].evaluations);
    EXPECT_EQ(generations_a[i].best, generations_b[i].best);
    EXPECT_EQ(generations_a[i].median, generations_b[i].median);
    EXPECT_EQ(generations_a[i].diverged, generations_b[i].diverged);
    EXPECT_EQ(generations_a[i].invalid, generations_b[i].invalid);
    EXPECT_EQ(generations_a[i].artefact, generations_b[i].artefact);
    EXPECT_EQ(generations_a[i].passive, generations_b[i].passive);
    EXPECT_EQ(generations_a[i].clones, generations_b[i].clones);
    EXPECT_EQ(generations_a[i].spring_evaluations, generations_b[i].spring_evaluations);
  }
  std::uint32_t id = 0;
  for (; a.individual(id); ++id) {
    const ArchivedIndividual one = *a.individual(id);
    ASSERT_TRUE(b.individual(id).has_value());
    const ArchivedIndividual other = *b.individual(id);
    EXPECT_EQ(one.genome, other.genome);
    EXPECT_EQ(one.born, other.born);
    EXPECT_EQ(one.died, other.died);
    EXPECT_EQ(one.origin, other.origin);
    EXPECT_EQ(one.parents, other.parents);
    EXPECT_EQ(one.made_by, other.made_by);
    EXPECT_EQ(one.result.status, other.result.status);
    EXPECT_EQ(one.result.reason, other.result.reason);
    EXPECT_EQ(one.result.ended_at, other.result.ended_at);
    EXPECT_EQ(one.result.objectives, other.result.objectives);
    EXPECT_EQ(one.result.measures, other.result.measures);
    EXPECT_EQ(one.result.spring_evaluations, other.result.spring_evaluations);
    const std::vector<ArchivedTest> tests = a.tests(id), other_tests = b.tests(id);
    ASSERT_EQ(tests.size(), other_tests.size()) << id;
    for (std::size_t i = 0; i < tests.size(); ++i) EXPECT_EQ(tests[i].value, other_tests[i].value) << id;
    EXPECT_EQ(a.life(id), b.life(id)) << id;
  }
  EXPECT_FALSE(b.individual(id).has_value());
  EXPECT_GT(id, 0u);
}

}  // namespace evodevo::testing
