// Runs with islands: settings, neighbours, migration, and interruptions.
#include "support/islands.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "evolution/islands/migration.hpp"
#include "experiment/islands/island_tables.hpp"
#include "experiment/islands/neighbours.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using Numbers = std::vector<std::int64_t>;

std::vector<Numbers> all_destinations(const IslandSettings& islands) {
  std::vector<Numbers> all;
  for (std::int64_t island = 1; island <= islands.count; ++island) all.push_back(destinations_of(island, islands));
  return all;
}

TEST(Neighbours, OfARingAreTheNextOnesAndOfAStarOrAFullGraphAllOthers) {
  EXPECT_THAT(all_destinations({.count = 5, .topology = Topology::ring}),
              ElementsAre(Numbers{2}, Numbers{3}, Numbers{4}, Numbers{5}, Numbers{1}));
  EXPECT_THAT(all_destinations({.count = 2, .topology = Topology::ring}), ElementsAre(Numbers{2}, Numbers{1}));
  EXPECT_THAT(all_destinations({.count = 4, .topology = Topology::star}),
              ElementsAre(Numbers{2, 3, 4}, Numbers{1}, Numbers{1}, Numbers{1}));
  EXPECT_THAT(all_destinations({.count = 3, .topology = Topology::full}),
              ElementsAre(Numbers{2, 3}, Numbers{1, 3}, Numbers{1, 2}));
}

/// 1 2 3 4      1 2 3    1 2 3
/// 5 6 7 8      4 5 6    4 5 6
/// 9 10 11 12            7 8 9
TEST(Neighbours, OfATorusAreTheUpToFourOnAGrid) {
  EXPECT_THAT(all_destinations({.count = 12, .topology = Topology::torus}),
              ElementsAre(Numbers{2, 4, 5, 9}, Numbers{1, 3, 6, 10}, Numbers{2, 4, 7, 11}, Numbers{1, 3, 8, 12},
                          Numbers{1, 6, 8, 9}, Numbers{2, 5, 7, 10}, Numbers{3, 6, 8, 11}, Numbers{4, 5, 7, 12},
                          Numbers{1, 5, 10, 12}, Numbers{2, 6, 9, 11}, Numbers{3, 7, 10, 12}, Numbers{4, 8, 9, 11}));
  EXPECT_THAT(all_destinations({.count = 6, .topology = Topology::torus}),
              ElementsAre(Numbers{2, 3, 4}, Numbers{1, 3, 5}, Numbers{1, 2, 6}, Numbers{1, 5, 6}, Numbers{2, 4, 6},
                          Numbers{3, 4, 5}));
  const IslandSettings square{.count = 9, .topology = Topology::torus};
  EXPECT_THAT(destinations_of(5, square), ElementsAre(2, 4, 6, 8));
  EXPECT_THAT(destinations_of(9, square), ElementsAre(3, 6, 7, 8));
}

TEST(Neighbours, ReceiveFromThoseWhoSendToThem) {
  for (const Topology topology : {Topology::ring, Topology::torus, Topology::star, Topology::full}) {
    const IslandSettings islands{.count = 15, .topology = topology};
    for (std::int64_t to = 1; to <= 15; ++to) {
      Numbers senders;
      for (std::int64_t from = 1; from <= 15; ++from)
        if (const Numbers sent = destinations_of(from, islands); std::ranges::find(sent, to) != sent.end())
          senders.push_back(from);
      EXPECT_EQ(sources_of(to, islands), senders) << name_of(topology) << ' ' << to;
      EXPECT_LE(static_cast<std::int64_t>(senders.size()), most_sources(islands));
    }
  }
}

class Islands : public ::testing::Test {
 protected:
  std::vector<Experiment> read(std::vector<Override> overrides = {}) const {
    return testing::read_islands(scratch_, testing::small_islands, std::move(overrides));
  }
  void straight(std::vector<Experiment> islands) const {
    testing::evolve_islands(std::move(islands), scratch_ / "straight", 1);
  }
  Archive archive(std::int64_t island) const { return Archive::read(island_folder(scratch_ / "straight", island)); }

  testing::Scratch scratch_;
};

using IslandTables = Islands;

TEST_F(IslandTables, GiveEachIslandWhatIsItsOwn) {
  const std::vector<Experiment> islands = read();
  ASSERT_EQ(islands.size(), 3u);
  std::set<std::int64_t> seeds{7};
  for (const Experiment& island : islands) {
    EXPECT_EQ(island.island, &island - islands.data() + 1);
    EXPECT_TRUE(seeds.insert(island.seed).second) << "of another island, or of the run";
    EXPECT_EQ(island.layout, islands[0].layout);
    EXPECT_EQ(island.call_of(Selection::kind, 0).title->whole.find("elitist") != std::string::npos, island.island == 2);
    EXPECT_EQ(island.crossovers.size(), 1u);
  }
  EXPECT_EQ(islands[0].seed, island_seed(7, 1));
  EXPECT_EQ(islands[2].seed, 41);
  EXPECT_EQ(islands[0].mutations.front().probability, 0.8);
  EXPECT_EQ(islands[2].mutations.front().probability, 0.35);
  EXPECT_THAT((Numbers{islands[0].evaluations, islands[1].evaluations, islands[2].evaluations}),
              ElementsAre(35, 35, 34));
}

TEST_F(IslandTables, AreReadBackFromTheRecordAndDivideTheSpringEvaluations) {
  for (const Experiment& island : read({{"experiment.spring_evaluations", "3e9", ""}})) {
    const Experiment again = testing::read(island.resolved);
    EXPECT_EQ(again.resolved, island.resolved);
    EXPECT_EQ(again.development.seed, 7) << "that of the run: islands exchange robots, which bring it along";
    EXPECT_EQ(again.islands, island.islands);
    EXPECT_EQ(island.spring_evaluations, 1e9);
  }
}

TEST_F(IslandTables, ThatCannotWorkAreRefused) {
  const std::string file = (scratch_ / "islands.toml").string() + ":";
  const auto complaint = [&](const std::vector<Override>& overrides) {
    return testing::refusal<ConfigError>([&] { read(overrides); });
  };
  EXPECT_THAT(complaint({{"islands.topology", "torus", "--set"}}), testing::naming("islands.topology", "3 islands"));
  EXPECT_THAT(complaint({{"islands.migrants", "5", "--set"}}), testing::naming("islands.migrants", "5", "at most 4"));
  EXPECT_THAT(complaint({{"islands.migrants", "3", "--set"}, {"islands.topology", "full", ""}}),
              testing::naming("islands.migrants", "6 immigrants", "at most 4"));
  EXPECT_THAT(complaint({{"islands.count", "1", "--set"}}), testing::naming("islands.count", "1"));
  EXPECT_THAT(complaint({{"experiment.evaluations", "2", ""}}), testing::naming(file, "2 evaluations", "3 islands"));
  EXPECT_THAT(complaint({{"island.0.number", "4", "--set"}}), testing::naming("island.0.number", "4", "3"));
  EXPECT_THAT(complaint({{"island.0.number", "3", "--set"}}), testing::naming("island.1.number", "3"));
  EXPECT_THAT(complaint({{"island.1.seed", "0.5", "--set"}}), testing::naming("island.1.seed", "0.5", "whole number"));
  EXPECT_THAT(complaint({{"island.1.mutation.0.name", "gaussian", ""}}), testing::naming(file, "island 3", "gaussian"));
  EXPECT_THAT(complaint({{"island.1.population", "7", ""}}), testing::naming("population"));
  EXPECT_THAT(complaint({{"island.0.selection.name", "elitis", ""}}), testing::naming("elitis", "elitist"));
  const std::string none = testing::small_experiment + "[[island]]\nnumber = 1\n";
  EXPECT_THROW(testing::read_islands(scratch_, none), ConfigError) << "without islands";
  EXPECT_EQ(testing::read_islands(scratch_, testing::small_experiment).front().island, 0);
}

TEST_F(Islands, GoOnFromEveryInterruption) {
  straight(read());
  for (std::int64_t island = 1; island <= 3; ++island)
    for (std::uint32_t generation = 0; generation < 7; ++generation) {
      const fs::path folder = scratch_ / (std::to_string(island) + "." + std::to_string(generation));
      testing::evolve_islands(read(), folder, 2, testing::Interruption{island, generation});
      testing::evolve_islands(read(), folder, 1);
      testing::expect_same_islands(scratch_ / "straight", folder);
    }
}

TEST_F(Islands, GoOnWhereverEachOfThemStands) {
  straight(read());
  EXPECT_THAT(archive(1).emigrants_to(2, 0), ::testing::SizeIs(3)) << "after generations 1, 3 and 5";
  testing::evolve_islands(read(), scratch_ / "early", 1, testing::Interruption{1, 1});
  const fs::path mixed = scratch_ / "mixed";
  fs::create_directory(mixed);
  for (const auto& [island, from] : {std::pair{1, "early"}, {2, "straight"}, {3, "early"}})
    fs::copy(island_folder(scratch_ / from, island), island_folder(mixed, island));
  EXPECT_LT(Archive::read(island_folder(mixed, 1)).generations().size(), 7u);
  testing::evolve_islands(read(), mixed, 2);
  testing::expect_same_islands(scratch_ / "straight", mixed);
}

TEST_F(Islands, SendTheirBestWhoAreBornAgain) {
  straight(read({{"islands.every", "1", ""}, {"development.draws", "individual", ""}}));
  int arrived = 0;
  for (std::int64_t island = 1; island <= 3; ++island) {
    const Archive here = archive(island), source = archive(island == 1 ? 3 : island - 1);
    const auto sent = source.emigrants_to(island, 0);
    EXPECT_THAT(sent, ::testing::SizeIs(7)) << "after each generation";
    for (std::uint32_t id = 0; here.individual(id); ++id) {
      const ArchivedIndividual immigrant = *here.individual(id);
      EXPECT_EQ(immigrant.made_by == "migration", immigrant.migrated.has_value());
      if (!immigrant.migrated) continue;
      ++arrived;
      const ArchivedIndividual home = source.known_individual(immigrant.migrated->individual);
      EXPECT_THAT(sent.at(immigrant.born - 1), ElementsAre(home.id));
      EXPECT_EQ(immigrant.genome, home.genome);
      EXPECT_EQ(immigrant.origin, home.origin);
      EXPECT_TRUE(immigrant.parents.empty());
      for (const Membership& other : source.memberships(0))
        if (other.born < immigrant.born && (!other.died || *other.died >= immigrant.born)) {
          EXPECT_LE(other.value, home.result.objectives.front()) << "a better one stayed";
        }
    }
  }
  EXPECT_GE(arrived, 3);
}

TEST_F(Islands, ReceiveThoseWhoseGenesTheyDoNotHave) {
  straight(
      read({{"islands.every", "1", ""}, {"islands.emigrants", "random", ""}, {"development.draws", "individual", ""}}));
  const Archive here = archive(2), source = archive(1);
  std::size_t arrived = 0, sent = 0;
  for (const auto& [generation, ids] : source.emigrants_to(2, 0)) {
    if (generation + 1 >= here.generations().size()) continue;  // after the last generation, nobody is born
    ++sent;
    const Genome genome = source.known_individual(ids.at(0)).genome;
    bool is_here = false, has_come = false;
    for (std::uint32_t id = 0; here.individual(id); ++id) {
      const ArchivedIndividual one = *here.individual(id);
      has_come |= one.migrated == Migrated{1, ids.at(0)} && one.born == generation + 1;
      is_here |= one.genome.genes == genome.genes && one.born <= generation && (!one.died || *one.died > generation);
    }
    EXPECT_NE(is_here, has_come) << generation;
    arrived += has_come;
  }
  EXPECT_EQ(sent, 6u);
  EXPECT_GE(arrived, 3u);
}

/// Individuals whose first objective is their id.
std::vector<Individual> ranked_by_id(std::initializer_list<std::uint32_t> ids) {
  std::vector<Individual> individuals;
  for (const std::uint32_t id : ids) {
    Individual& one = individuals.emplace_back();
    one.id = id;
    one.result.objectives = {static_cast<double>(id), 0};
  }
  return individuals;
}

/// Lets immigrant 17, born in generation 4, claim a place among survivors 2, 5, 9, 11 and 14, of which 2 is the best.
TEST_F(Islands, LetAnImmigrantReplaceNobodyOrTheWorstOrARandomOne) {
  for (const std::string rule : {"nobody", "worst", "random"}) {
    const Experiment island = std::move(read({{"islands.replaced", rule, ""}}).front());
    LocalExchange exchange;
    const Migration migration(island, exchange);
    std::vector<Individual> everyone = ranked_by_id({17}), survivors = ranked_by_id({2, 5, 9, 11, 14});
    everyone.front().born = 4;
    everyone.front().migrated = Migrated{2, 3};
    survivors[0].result.objectives = {100, 0};
    std::vector<std::uint32_t> dropped = {17, 1}, ids;
    migration.replace(migration.claimants(everyone, 4), 4, survivors, dropped);
    for (const Individual& one : survivors) ids.push_back(one.id);
    if (rule == "nobody") {
      EXPECT_THAT(ids, ElementsAre(2, 5, 9, 11, 14));
      EXPECT_THAT(dropped, ElementsAre(17, 1));
    } else if (rule == "worst") {
      EXPECT_THAT(ids, ElementsAre(2, 9, 11, 14, 17));
      EXPECT_THAT(dropped, ::testing::UnorderedElementsAre(1, 5));
    } else {
      EXPECT_THAT(ids, ::testing::AllOf(::testing::Contains(17), ::testing::SizeIs(5)));
      EXPECT_THAT(dropped, ::testing::AllOf(::testing::Not(::testing::Contains(17)), ::testing::SizeIs(2)));
    }
  }
}

TEST_F(Islands, AreRefusedWhereOneArchiveIsExpected) {
  straight(read());
  const fs::path folder = scratch_ / "straight";
  EXPECT_THAT([&] { Archive::read(folder); },
              ::testing::ThrowsMessage<ArchiveError>(testing::naming(folder.string(), (folder / "island-1").string())));
  fs::remove_all(folder / "island-2");
  EXPECT_THROW(island_folders(folder), ArchiveError);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
