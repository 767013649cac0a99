// The selections tournament, lexicase and comma.
#include <set>

#include "evolution.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

TEST(Tournament, TheBestOfSomeDrawsIsAParent) {
  Table table;
  for (std::uint32_t i = 0; i < 10; ++i) table.rows.push_back({.scores = {10.0 - i}, .id = i});
  const auto selection = make<Selection>("tournament", "size = 3");
  EXPECT_FALSE(selection->overrides.survivors);
  std::vector<double> share(10, 0);
  for (const auto& [parent, mate] : table.parents(*selection, 20000)) {
    EXPECT_NE(parent, mate);
    share[parent] += 1000.0 / 20000;
  }
  // all three draws are at least i in (10 - i)^3 of 1000 cases
  for (int i = 0; i < 10; ++i)
    EXPECT_NEAR(share[static_cast<std::size_t>(i)], std::pow(10 - i, 3) - std::pow(9 - i, 3), 15) << i;
}

TEST(LexicaseParents, AreSpecialistsAndSoAreTheirMates) {
  const auto selection = make<Selection>("lexicase", "tolerance = 0");
  EXPECT_FALSE(selection->overrides.survivors);
  // rows 0 and 2 are the best in a case; row 1 is the best on average, and row 3 has failed
  const Table table{.rows = {{.scores = {3}, .cases = {9, 0, 0}},
                             {.scores = {5}, .cases = {5, 5, 5}},
                             {.scores = {4}, .cases = {0, 6, 6}},
                             {}}};
  int first = 0;
  for (const auto& [parent, mate] : table.parents(*selection, 3000)) {
    EXPECT_TRUE(parent == 0 || parent == 2);
    EXPECT_NE(mate, parent);
    EXPECT_NE(mate, 3u);
    first += parent == 0;
  }
  EXPECT_NEAR(first, 1000, 150) << "its case comes first in a third of the orders";
}

TEST(LexicaseParents, ToleranceIsTheMedianDeviationUnlessSet) {
  // the deviations from the median 9 are 0, 1, 1, 2 and 9, so that scores from 10 are as good as 11
  Table table;
  for (const double score : {9, 10, 8, 11, 0}) table.rows.push_back({.scores = {1}, .cases = {score}});
  const auto parents_with = [&](const std::string& parameters) {
    std::set<std::uint32_t> parents;
    const auto selection = make<Selection>("lexicase", parameters);
    for (const auto& [parent, mate] : table.parents(*selection, 300)) parents.insert(parent);
    return parents;
  };
  EXPECT_EQ(parents_with(""), (std::set<std::uint32_t>{1, 3}));
  EXPECT_EQ(parents_with("tolerance = 0"), (std::set<std::uint32_t>{3}));
  EXPECT_EQ(parents_with("tolerance = 2"), (std::set<std::uint32_t>{0, 1, 3}));
}

TEST(LexicaseParents, MayBeOneOrAllWhoFailed) {
  const auto selection = make<Selection>("lexicase");
  const Table alone{.rows = {{.scores = {1}, .cases = {1}}, {}}}, failed{.rows = {{}, {}, {}}};
  for (const auto& [parent, mate] : alone.parents(*selection, 10)) EXPECT_EQ(parent + mate, 0u);
  std::set<std::uint32_t> parents;
  for (const auto& [parent, mate] : failed.parents(*selection, 100)) parents.insert(parent);
  EXPECT_EQ(parents.size(), 3u);
}

TEST(Comma, TheBestNewbornsSurvive) {
  const auto selection = make<Selection>("comma");
  EXPECT_FALSE(selection->traits().is_elitist);
  const Table table{.rows = {{.scores = {100}},
                             {.scores = {90}},
                             {.scores = {3}, .is_newborn = true},
                             {.scores = {7}, .is_newborn = true},
                             {.scores = {5}, .is_newborn = true},
                             {.is_newborn = true}}};
  EXPECT_THAT(table.survivors(*selection, 2).rows, ::testing::UnorderedElementsAre(3, 4));
  EXPECT_THAT(table.survivors(*selection, 4).rows, ::testing::UnorderedElementsAre(3, 4, 2, 0))
      << "a place is left, which the best of the old takes before a newborn that failed";
  EXPECT_THAT(table.survivors(*selection, 10).rows, ::testing::SizeIs(6));
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
