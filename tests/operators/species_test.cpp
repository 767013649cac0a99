// Species by homology, and how they share fitness.
#include <set>

#include "evolution.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// Individuals whose only gene is from 0 to 1.
Table with_genes(const std::vector<std::pair<float, double>>& genes_and_scores) {
  Table table{.layout = real_genes(1, 0, 1)};
  for (const auto& [gene, score] : genes_and_scores)
    table.rows.push_back({.scores = {score}, .genome = {gene}, .id = static_cast<std::uint32_t>(table.rows.size())});
  return table;
}

/// Returns the rows of each species, by the numbers that the operator notes.
std::map<double, std::set<std::uint32_t>> species_in(const Survival& survival) {
  std::map<double, std::set<std::uint32_t>> species;
  for (const Note& note : survival.notes) species[note.value].insert(note.row);
  return species;
}

using Groups = std::set<std::set<std::uint32_t>>;

/// Returns the species into which an operator with these parameters divides a table.
Groups groups(const Table& table, const std::string& toml) {
  Groups result;
  const auto population = static_cast<std::uint32_t>(table.rows.size());
  for (const auto& [number, rows] : species_in(table.survivors(*make<Selection>("species", toml), population)))
    result.insert(rows);
  return result;
}

/// Returns how often each row is a parent, relative to all draws.
std::vector<double> shares(const Selection& selection, const Table& table, std::uint32_t draws = 20000) {
  std::vector<double> share(table.rows.size(), 0);
  for (const auto& [parent, mate] : table.parents(selection, draws)) share[parent] += 1.0 / draws;
  return share;
}

TEST(Species, AreGroupsOfSimilarGenomes) {
  const Table table = with_genes({{0.1f, 5}, {0.9f, 4}, {0.15f, 3}, {0.85f, 2}, {0.5f, 1}});
  EXPECT_EQ(groups(table, "threshold = 0.1"), (Groups{{0, 2}, {1, 3}, {4}}));
  EXPECT_EQ(groups(table, "threshold = 1"), (Groups{{0, 1, 2, 3, 4}}));
  EXPECT_EQ(groups(table, "threshold = 0").size(), 5u);
  EXPECT_EQ(groups(table, "threshold = 0.1\ngene_weight = 0").size(), 1u) << "differences between genes do not count";
  // the best members are at 0.2 and 0.5; 0.36 is similar enough to both, and nearer to the second
  EXPECT_EQ(groups(with_genes({{0.2f, 9}, {0.5f, 8}, {0.36f, 1}}), "threshold = 0.2"), (Groups{{0}, {1, 2}}));
}

TEST(Species, DifferByBlocksWithoutCounterpart) {
  Table table;
  const auto node = table.layout.add_type({.name = "node", .genes = {{.low = 0, .high = 1}}, .least = 0, .most = 9});
  const auto genome = [&](std::vector<BlockId> ids) {
    Genome made;
    for (const BlockId id : ids) add_block(made, table.layout, node, std::vector{0.5f}, id);
    return made;
  };
  table.rows = {{.scores = {3}, .genome = genome({1, 2, 3, 4}), .id = 0},
                {.scores = {2}, .genome = genome({1, 2, 3, 5}), .id = 1},   // 2 of 8 have none
                {.scores = {1}, .genome = genome({1, 6, 7, 8}), .id = 2}};  // 6 of 8
  EXPECT_EQ(groups(table, "threshold = 0.3"), (Groups{{0, 1}, {2}}));
}

TEST(Species, KeepTheirNumbersThroughGenerations) {
  const auto selection = make<Selection>("species", "threshold = 0.2");
  Table table = with_genes({{0.1f, 5}, {0.9f, 4}});
  const Survival first = table.survivors(*selection, 2);
  const auto numbers = species_in(first);
  ASSERT_EQ(numbers.size(), 2u);
  table.keep(*selection, first);
  const double low = table.rows[0].notes["species"], high = table.rows[1].notes["species"];
  // newborns, the best of all among them, and a new species
  table.rows.push_back({.scores = {9}, .genome = {0.8f}, .id = 10, .is_newborn = true});
  table.rows.push_back({.scores = {1}, .genome = {0.2f}, .id = 11, .is_newborn = true});
  table.rows.push_back({.scores = {1}, .genome = {0.5f}, .id = 12, .is_newborn = true});
  table.keep(*selection, table.survivors(*selection, 5));
  ASSERT_EQ(table.rows.size(), 5u);
  EXPECT_EQ(table.rows[0].notes["species"], low);
  EXPECT_EQ(table.rows[1].notes["species"], high);
  EXPECT_EQ(table.rows[2].notes["species"], high);
  EXPECT_EQ(table.rows[3].notes["species"], low);
  const double founded = table.rows[4].notes["species"];
  EXPECT_GT(founded, std::max(low, high));
  // when a species has died out, its number is not given to another one
  std::erase_if(table.rows, [](const Individual& one) { return one.id == 12; });
  table.keep(*selection, table.survivors(*selection, 5));
  table.rows.push_back({.scores = {1}, .genome = {0.5f}, .id = 13, .is_newborn = true});
  table.keep(*selection, table.survivors(*selection, 5));
  EXPECT_GT(table.rows.back().notes["species"], founded);
}

/// Those who survive are chosen one by one, each for the greatest share that is left.
TEST(Species, SurvivorsAreThoseOfAFullSearch) {
  const auto selection = make<Selection>("species", "threshold = 0.1");
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Rng rng = stream(seed);
    std::vector<std::pair<float, double>> rows;
    for (int i = 0; i < 40; ++i) rows.emplace_back(static_cast<float>(rng.uniform()), rng.below(20));
    const Table table = with_genes(rows);
    const Survival survival = table.survivors(*selection, 15);
    std::map<std::uint32_t, double> species;
    for (const Note& note : survival.notes) species[note.row] = note.value;
    std::map<double, int> members;
    std::set<std::uint32_t> chosen;
    for (const std::uint32_t row : survival.rows) {
      const auto share = [&](std::uint32_t i) { return rows[i].second / (1 + members[species[i]]); };
      for (std::uint32_t i = 0; i < 40; ++i) EXPECT_TRUE(chosen.contains(i) || share(row) >= share(i)) << seed;
      ++members[species[row]];
      chosen.insert(row);
    }
    EXPECT_EQ(chosen.size(), 15u);
  }
}

TEST(Species, AMemoryThatIsNotItsOwnIsRefused) {
  const auto selection = make<Selection>("species");
  Table table = with_genes({{0.1f, 5}, {0.11f, 4}});
  const auto refusal_of = [&](std::vector<double> ids, std::vector<double> species, std::vector<double> next) {
    table.memory.lists = {{"ids", ids}, {"species", species}, {"next", next}};
    return testing::refusal<std::runtime_error>([&] { table.parents(*selection, 2); });
  };
  EXPECT_THAT(refusal_of({0, 1}, {1}, {3}), testing::naming("1 individuals", "expected 2"));
  EXPECT_THAT(refusal_of({0, 1}, {1, 2}, {}), testing::naming("0 next"));
  for (const double wrong : {-1.0, 0.5, 1e10})
    EXPECT_THAT(refusal_of({0, 1}, {1, wrong}, {3}), testing::naming("\"species\"", "whole")) << wrong;
}

TEST(Species, ParentsShareTheFitnessOfTheirSpecies) {
  const auto selection = make<Selection>("species");
  Table table = with_genes({{0.1f, 5}, {0.11f, 4}, {0.12f, 3}, {0.9f, 2}, {0.91f, 1}});
  table.keep(*selection, table.survivors(*selection, 5));
  for (const auto& [parent, mate] : table.parents(*selection, 1000)) {
    EXPECT_NE(parent, mate);
    EXPECT_EQ(mate < 3, parent < 3) << "of another species";
  }
  const double worth[] = {5 / 3.0, 4 / 3.0, 3 / 3.0, 2 / 2.0, 1 / 2.0};
  const auto share = shares(*selection, table, 40000);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(share[i], worth[i] / 5.5, 0.015) << i;
}

TEST(Species, WithoutMemoryAllAreOne) {
  const auto selection = make<Selection>("species");
  Table one_failed = with_genes({{0.1f, 3}, {0.9f, 1}, {0.5f, 2}});
  one_failed.rows[2].scores.clear();
  const std::pair<Table, std::vector<double>> cases[] = {
      {with_genes({{0.1f, 3}, {0.9f, 2}, {0.5f, 1}}), {3.0 / 6, 2.0 / 6, 1.0 / 6}},
      {with_genes({{0.1f, 3}, {0.9f, 3}, {0.5f, 3}}), {1.0 / 3, 1.0 / 3, 1.0 / 3}},
      // counted from the lowest score, if it is below 0
      {with_genes({{0.1f, 1}, {0.9f, -1}, {0.5f, -3}}), {2.0 / 3, 1.0 / 3, 0}},
      {one_failed, {3.0 / 4, 1.0 / 4, 0}}};
  for (const auto& [table, expected] : cases) {
    const auto share = shares(*selection, table);
    EXPECT_THAT(share, ::testing::Pointwise(::testing::DoubleNear(0.02), expected));
    EXPECT_EQ(share[2] == 0, expected[2] == 0);
  }
}

TEST(Species, BecomeOneWhenTheyAreSimilar) {
  const auto selection = make<Selection>("species", "threshold = 0.2");
  Table table = with_genes({{0.1f, 5}, {0.4f, 4}});
  table.keep(*selection, table.survivors(*selection, 2));
  EXPECT_NE(table.rows[0].notes["species"], table.rows[1].notes["species"]);
  table.rows[1].genome[0] = 0.25f;
  table.rows[1].scores[0] = 6;
  const double number = table.rows[1].notes["species"];
  table.keep(*selection, table.survivors(*selection, 2));
  EXPECT_EQ(table.rows[0].notes["species"], number) << "that of the better one";
  EXPECT_EQ(table.rows[1].notes["species"], number);
}

TEST(Species, FailedRowsDieUnlessAllFailed) {
  const auto selection = make<Selection>("species");
  Table table = with_genes({{0.1f, 3}, {0.9f, 1}, {0.5f, 2}});
  table.rows[2].scores.clear();
  EXPECT_THAT(table.survivors(*selection, 3).rows, ::testing::UnorderedElementsAre(0, 1));
  for (Individual& one : table.rows) one.scores.clear();
  EXPECT_THAT(table.survivors(*selection, 2).rows, ::testing::SizeIs(2));
  EXPECT_THAT(table.parents(*selection, 7), ::testing::SizeIs(7));
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
