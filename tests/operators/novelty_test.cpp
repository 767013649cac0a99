// Novelty search and its archive.
#include "evolution.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

using ::testing::DoubleNear;
using ::testing::Pointwise;

const std::vector<Objective> one_range{{"x", "m", true, Role::descriptor, 0, 10}};

Table at(const std::vector<double>& places) {
  Table table{.descriptors = one_range};
  for (const double place : places)
    table.rows.push_back({.scores = {0},
                          .descriptors = {place},
                          .id = static_cast<std::uint32_t>(table.rows.size()),
                          .is_newborn = true});
  return table;
}

std::vector<double> archived(const std::optional<SelectionMemory>& memory) {
  std::vector<double> places = memory.value().list("places");
  for (double& place : places) place *= 10;
  std::sort(places.begin(), places.end());
  return places;
}

TEST(NoveltySearch, TheMostDistantSurviveWhateverTheirScores) {
  const auto selection = make<Selection>("novelty", "neighbours = 2\narchived = 0");
  EXPECT_FALSE(selection->traits().is_elitist);
  Table table = at({0, 1, 1.5, 2, 9});
  table.rows[2].scores = {1000};
  const Survival survival = table.survivors(*selection, 2);
  EXPECT_THAT(survival.rows, ::testing::UnorderedElementsAre(0, 4));
  std::map<std::uint32_t, double> noted;
  for (const Note& note : survival.notes) noted[note.row] = note.value;
  // mean distances to the two nearest, relative to the range of 10
  EXPECT_NEAR(noted[0], (1 + 1.5) / 2 / 10, 1e-12);
  EXPECT_NEAR(noted[2], 0.05, 1e-12);
  EXPECT_NEAR(noted[4], (7 + 7.5) / 2 / 10, 1e-12);
}

TEST(NoveltySearch, AMemoryOfImpossiblePlacesIsRefused) {
  const auto selection = make<Selection>("novelty", "neighbours = 1\narchived = 100");
  Table table = at({9, 9.1});
  const auto survive_with = [&](const std::vector<double>& place) {
    table.memory.lists = {{"ids", {70}}, {"scores", {0}}, {"places", place}};
    table.survivors(*selection, 2);
  };
  EXPECT_NO_THROW(survive_with({0.9}));
  for (const std::vector<double>& place : {std::vector<double>{}, {0.9, 0.9}, {-1e200}})
    EXPECT_THAT([&] { survive_with(place); },
                ::testing::ThrowsMessage<std::runtime_error>(::testing::HasSubstr("1 descriptors")));
}

TEST(NoveltySearch, WhatIsInTheArchiveIsNotNovel) {
  const auto selection = make<Selection>("novelty", "neighbours = 1\narchived = 100");
  Table table = at({9, 9.1});
  table.memory = table.survivors(*selection, 2).memory.value();
  EXPECT_THAT(archived(table.memory), Pointwise(DoubleNear(1e-9), {9.0, 9.1}));
  table.rows = at({2, 3, 9}).rows;
  for (Individual& one : table.rows) one.id += 100;
  EXPECT_THAT(table.survivors(*selection, 2).rows, ::testing::UnorderedElementsAre(0, 1));
}

TEST(NoveltySearch, ThoseInTheArchiveWhoAreAliveCountOnce) {
  for (const char* competition : {"false", "true"}) {
    const auto selection =
        make<Selection>("novelty", std::string("neighbours = 2\narchived = 100\nlocal_competition = ") + competition);
    Table table = at({1, 2, 4, 8});
    const Survival first = table.survivors(*selection, 2);
    table.memory = first.memory.value();
    const Survival second = table.survivors(*selection, 2);
    EXPECT_EQ(second.rows, first.rows);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(second.notes.at(i).value, first.notes.at(i).value) << i;
  }
}

TEST(NoveltySearch, ForgetsThoseInTheArchiveWhoLoseTheirFitness) {
  const auto selection = make<Selection>("novelty", "neighbours = 1\narchived = 100");
  Table table = at({1, 2, 4, 8});
  table.memory = table.survivors(*selection, 4).memory.value();
  ASSERT_EQ(archived(table.memory).size(), 4u);
  for (Individual& one : table.rows) one.is_newborn = false;
  table.rows[1] = {.id = 1};
  EXPECT_THAT(archived(table.survivors(*selection, 4).memory), Pointwise(DoubleNear(1e-9), {1.0, 4.0, 8.0}));
}

TEST(NoveltySearch, BearsTheGreatestDescriptors) {
  const auto selection = make<Selection>("novelty", "neighbours = 1\narchived = 1");
  Table table = at({1e300, -1e308, 1.7e308, 1, 2});
  const Survival survival = table.survivors(*selection, 3);
  EXPECT_THAT(survival.rows, ::testing::Contains(1));
  ASSERT_EQ(survival.notes.size(), 5u);
  for (const Note& note : survival.notes) EXPECT_TRUE(std::isfinite(note.value)) << note.row;
}

TEST(NoveltySearch, TheArchiveGrowsByRandomNewborns) {
  const auto selection = make<Selection>("novelty", "archived = 3");
  Table table = at({1, 2, 3, 4, 5, 6, 7, 8});
  for (std::uint32_t i = 0; i < 4; ++i) table.rows[i].is_newborn = false;
  table.rows[7].scores.clear();
  table.rows[7].descriptors.clear();
  const auto first = archived(table.survivors(*selection, 4, 1).memory);
  ASSERT_EQ(first.size(), 3u);
  for (const double place : first) EXPECT_TRUE(place > 4.5 && place < 7.5) << place;
  table = at({1, 2, 3, 4, 5, 6, 7, 8});
  EXPECT_NE(archived(table.survivors(*selection, 4, 1).memory), archived(table.survivors(*selection, 4, 2).memory));
  for (std::uint64_t generation = 1; generation <= 5; ++generation) {
    table.memory = table.survivors(*selection, 4, generation).memory.value();
    EXPECT_EQ(archived(table.memory).size(), 3 * generation);
  }
}

TEST(NoveltySearch, LocalCompetitionKeepsTheBestAmongNeighbours) {
  // at each of two places, one individual is better than its neighbours
  Table table = at({1, 1.01, 1.02, 9, 9.02, 9.05});
  table.rows[1].scores = {5};
  table.rows[4].scores = {3};
  table.rows[5].scores = {2};
  const auto alone = make<Selection>("novelty", "neighbours = 2\narchived = 0");
  EXPECT_THAT(table.survivors(*alone, 2).rows, ::testing::UnorderedElementsAre(3, 5));
  // row 4 beats two neighbours, and row 5 one; row 1 also beats two, but is less novel than row 4
  const auto competing = make<Selection>("novelty", "neighbours = 2\narchived = 0\nlocal_competition = true");
  EXPECT_THAT(table.survivors(*competing, 2).rows, ::testing::UnorderedElementsAre(4, 5));
}

TEST(NoveltySearch, FailedRowsComeLastAndAreNotNoted) {
  const auto selection = make<Selection>("novelty");
  Table table = at({1, 1, 1});
  table.rows.push_back({.id = 3, .is_newborn = true, .violation = 2});
  table.rows.push_back({.id = 4, .is_newborn = true, .violation = 1});
  const Survival survival = table.survivors(*selection, 4);
  EXPECT_THAT(survival.rows, ::testing::UnorderedElementsAre(0, 1, 2, 4));
  for (const Note& note : survival.notes) EXPECT_LT(note.row, 3u);
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
