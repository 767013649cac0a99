// Which blocks of genomes come and go from parents to children.
#include "report/lineage.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evodevo/neat.hpp"
#include "report/genes_json.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

struct Network {
  Layout layout;
  neat::Types types = neat::add_types(layout, 1, 2, 9, 9);
  Genome parent;

  Network() {
    for (const BlockId id : {7, 8}) add(parent, types.node, {0, 0}, id);
    add(parent, types.link, {0.5F, 1, 0, 1}, 9);
  }
  void add(Genome& genome, std::uint32_t type, const std::vector<float>& genes, BlockId id) const {
    add_block(genome, layout, type, genes, id);
  }
};

TEST(Lineage, TellsWhichBlocksCameAndWent) {
  const Network network;
  Genome child = network.parent;
  network.add(child, network.types.node, {1, 1}, 20);
  network.add(child, network.types.link, {0.25F, 1, 1, 3}, 21);
  remove_block(child, network.layout, 0);  // and the first link with it
  const auto changes = block_changes(network.parent, child, network.layout);
  ASSERT_EQ(changes.size(), 2u);
  EXPECT_THAT(changes[0].came, ElementsAre(20));
  EXPECT_THAT(changes[0].went, ElementsAre(7));
  EXPECT_THAT(changes[1].came, ElementsAre(21));
  EXPECT_THAT(changes[1].went, ElementsAre(9));
  EXPECT_EQ(changes_text(changes, network.layout), ": +1 -1 node, +1 -1 link");
}

TEST(Lineage, ChangesOfGenesAreNoChangesOfBlocks) {
  const Network network;
  Genome child = network.parent;
  child[0] = 0.75F;
  EXPECT_THAT(block_changes(network.parent, child, network.layout), IsEmpty());
  EXPECT_EQ(changes_text({}, network.layout), "");
}

TEST(Lineage, WhereNothingComesOrGoesThereAreNoChanges) {
  Layout layout;
  layout.add_block(3, {-1, 1});
  EXPECT_THAT(block_changes({1, 0, 0}, {0, 0, 0}, layout), IsEmpty());
}

TEST(Lineage, IsToldFromTheYoungestToTheOldest) {
  const Network network;
  ArchivedIndividual child, parent, grandparent;
  child.id = 5;
  parent.id = 3;
  grandparent.id = 1;
  child.genome = parent.genome = grandparent.genome = network.parent;
  network.add(child.genome, network.types.node, {1, 1}, 20);
  network.add(grandparent.genome, network.types.node, {1, 1}, 30);
  const auto changes = line_changes_json({child, parent, grandparent}, network.layout);
  ASSERT_EQ(changes.size(), 2u);
  EXPECT_EQ(changes[0].at("individual"), 5);
  EXPECT_EQ(changes[0].at("type"), "node");
  EXPECT_THAT(changes[0].at("came"), ElementsAre(id_text(20)));
  EXPECT_EQ(changes[1].at("individual"), 3);
  EXPECT_THAT(changes[1].at("went"), ElementsAre(id_text(30)));
  EXPECT_THAT(changes[1].at("came"), IsEmpty());
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
