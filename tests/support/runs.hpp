// Comparison of runs.
#pragma once

#include <gtest/gtest.h>

#include <tuple>

#include "archive/archive.hpp"

namespace evodevo::testing {

inline auto all_but_wall_time(const Summary& s) {
  return std::tuple(s.evaluations, s.best, s.median, s.diverged, s.invalid, s.artefact, s.lucky, s.passive, s.clones,
                    s.spring_evaluations);
}

/// Expects that the individuals of both runs have the same genes, ancestry, results and recorded lives, and that the
/// generations have the same statistics, except for the wall time.
inline void expect_same_runs(const Archive& a, const Archive& b) {
  const auto generations_a = a.generations(), generations_b = b.generations();
  ASSERT_EQ(generations_a.size(), generations_b.size());
  for (std::size_t i = 0; i < generations_a.size(); ++i)
    EXPECT_EQ(all_but_wall_time(generations_a[i]), all_but_wall_time(generations_b[i])) << i;
  std::uint32_t id = 0;
  for (; a.individual(id); ++id) {
    const ArchivedIndividual one = *a.individual(id);
    ASSERT_TRUE(b.individual(id).has_value());
    const ArchivedIndividual other = *b.individual(id);
    EXPECT_EQ(one.genome, other.genome);
    EXPECT_EQ(
        std::tie(one.born, one.died, one.origin, one.parents, one.made_by, one.lives, one.measured),
        std::tie(other.born, other.died, other.origin, other.parents, other.made_by, other.lives, other.measured));
    const Result &r = one.result, &s = other.result;
    EXPECT_EQ(std::tie(r.status, r.reason, r.ended_at, r.objectives, r.lives, r.measures, r.spring_evaluations),
              std::tie(s.status, s.reason, s.ended_at, s.objectives, s.lives, s.measures, s.spring_evaluations));
    const std::vector<ArchivedTest> tests = a.tests(id), other_tests = b.tests(id);
    ASSERT_EQ(tests.size(), other_tests.size()) << id;
    for (std::size_t i = 0; i < tests.size(); ++i) {
      const ArchivedTest &x = tests[i], &y = other_tests[i];
      EXPECT_EQ(std::tie(x.life, x.scenario, x.repeat, x.objective, x.value),
                std::tie(y.life, y.scenario, y.repeat, y.objective, y.value))
          << id;
    }
    EXPECT_EQ(a.lives(id), b.lives(id)) << id;
  }
  EXPECT_FALSE(b.individual(id).has_value());
  EXPECT_GT(id, 0u);
}

}  // namespace evodevo::testing
