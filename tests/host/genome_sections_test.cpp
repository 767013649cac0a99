// Genomes whose blocks come and go, and genomes of several sections.
#include "base/genome_sections.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "base/philox.hpp"
#include "evodevo/blocks.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

Rng stream(std::uint64_t seed) { return Rng(philox, {seed, 0, 0, 0}); }

constexpr std::uint32_t node = 0, link = 1;

/// Nodes with a bias, and links with a weight between two nodes: three nodes and the links 0-1 and 1-2 at first.
Layout network() {
  Layout layout;
  layout.add_type({.name = "node", .genes = {{-2, 2}}, .least = 1, .most = 6});
  layout.add_type({.name = "link", .genes = {{-1, 1}, {.refers_to = node}, {.refers_to = node}}, .most = 8});
  for (int i = 0; i < 3; ++i) layout.add_block_of(node);
  for (int i = 0; i < 2; ++i) layout.add_block_of(link);
  return layout;
}

Genome chain() {
  Genome genome{0.5f, -0.5f, 1.5f, 0.25f, 0, 1, -0.25f, 1, 2};
  genome.blocks = network().first_blocks;
  return genome;
}

Layout fixed() {
  Layout layout;
  layout.add_block(2, {0, 1});
  layout.add_block(1, {0, 0, 3});
  return layout;
}

TEST(Blocks, OfFirstGenomesAreHomologous) {
  Rng rng = stream(1);
  const Genome one = random_genome(network(), rng), other = random_genome(network(), rng);
  EXPECT_NE(one.genes, other.genes);
  EXPECT_EQ(one.blocks, other.blocks);
  EXPECT_EQ(genome_fault(one, network()), "");
  std::set<BlockId> ids;
  for (const Block& block : one.blocks) ids.insert(block.id);
  EXPECT_EQ(ids.size(), 5u);
}

TEST(Blocks, ThatAreAddedComeAtTheEndOfTheirSection) {
  Genome genome = chain();
  EXPECT_EQ(add_block(genome, network(), node, std::vector{0.75f}, 77), 5u);
  EXPECT_THAT(genome.genes, ElementsAre(0.5f, -0.5f, 1.5f, 0.25f, 0, 1, -0.25f, 1, 2, 0.75f));
  EXPECT_EQ(genome.blocks.back(), (Block{node, 9, 1, 77}));
  EXPECT_EQ(genome_fault(genome, network()), "");
  EXPECT_EQ(find_block(genome, network(), 77), 5u);
  EXPECT_EQ(count_blocks(genome, network(), node), 4u);
}

TEST(Blocks, ThatGoTakeAlongWhatRefersToThem) {
  const auto without = [](std::uint32_t block) {
    Genome genome = chain();
    remove_block(genome, network(), block);
    EXPECT_EQ(genome_fault(genome, network()), "");
    return genome.genes;
  };
  EXPECT_THAT(without(0), ElementsAre(-0.5f, 1.5f, -0.25f, 0, 1)) << "the second link refers to nodes 0 and 1 now";
  EXPECT_THAT(without(1), ElementsAre(0.5f, 1.5f)) << "no link is left";
  EXPECT_THAT(without(3), ElementsAre(0.5f, -0.5f, 1.5f, -0.25f, 1, 2)) << "a link goes alone";
}

TEST(Blocks, ThatGoTakeAlongWhatRefersToThemInTurn) {
  Layout layout;  // each item refers to another
  layout.add_type({.name = "item", .genes = {{.refers_to = 0}}, .most = 9});
  for (int i = 0; i < 5; ++i) layout.add_block_of(0);
  Genome genome{0, 0, 1, 4, 4};  // 2 refers to 1, which refers to 0; 3 and 4 refer to 4
  genome.blocks = layout.first_blocks;
  remove_block(genome, layout, 0);
  EXPECT_THAT(genome.genes, ElementsAre(1, 1));
  EXPECT_EQ(genome_fault(genome, layout), "");
}

TEST(Blocks, HaveIdsThatTellDescent) {
  Rng rng = stream(1), same = stream(1);
  const BlockId fresh = fresh_id(rng);
  EXPECT_EQ(fresh_id(same), fresh);
  EXPECT_NE(fresh_id(rng), fresh);
  EXPECT_EQ(derived_id(5, 1), derived_id(5, 1)) << "the same split of the same link";
  EXPECT_NE(derived_id(5, 1), derived_id(5, 2));
  EXPECT_NE(derived_id(5, 1), derived_id(6, 1));
  EXPECT_NE(derived_id(5, 6, 1), derived_id(6, 5, 1)) << "a link has a direction";
}

TEST(Blocks, AreMatchedByTheirIds) {
  const Layout layout = network();
  Genome one = chain(), other = chain();
  add_block(one, layout, node, std::vector{1.0f}, 77);
  for (const BlockId id : {88, 77}) add_block(other, layout, node, std::vector{1.0f}, id);
  remove_block(other, layout, 0);
  // other: nodes 1 and 2, their link, nodes 88 and 77
  EXPECT_THAT(homologous(one, other, layout), ElementsAre(std::nullopt, 0u, 1u, std::nullopt, 2u, 4u));
}

TEST(Blocks, AreCopiedWithTheMeaningOfTheirReferences) {
  const Layout layout = network();
  Genome from = chain(), to = chain();
  remove_block(from, layout, 0);  // its link refers to blocks 0 and 1, which are 1 and 2 of the other
  from[2] = 0.875f;
  copy_genes(to, 4, from, 2, layout);
  EXPECT_THAT(to.genes, ElementsAre(0.5f, -0.5f, 1.5f, 0.25f, 0, 1, 0.875f, 1, 2));
  // a reference to what is not there stays as it was
  copy_genes(from, 2, chain(), 3, layout);
  EXPECT_THAT(from.genes, ElementsAre(-0.5f, 1.5f, 0.25f, 0, 0));
}

TEST(Blocks, MayBeDrawnAnew) {
  const Layout layout = network();
  Genome genome = chain();
  remove_block(genome, layout, 1);
  add_block(genome, layout, link, std::vector<float>{0, 0, 0}, 77);
  Rng rng = stream(3);
  std::set<float> drawn;
  for (int i = 0; i < 50; ++i) drawn.insert(layout.draw(genome, 3, rng));
  EXPECT_THAT(drawn, ElementsAre(0, 1)) << "a reference goes to any node and to nothing else";
}

TEST(GenomeFault, NamesWhatTheLayoutDoesNotAllow) {
  const auto fault_of = [](auto change) {
    Genome genome = chain();
    change(genome);
    return genome_fault(genome, network());
  };
  EXPECT_THAT(fault_of([](Genome& g) { g[0] = 2.5f; }), HasSubstr("gene 0 = 2.5"));
  EXPECT_THAT(fault_of([](Genome& g) { g[4] = 3; }), HasSubstr("gene 4 = 3")) << "a link to a link";
  EXPECT_THAT(fault_of([](Genome& g) { g[4] = 5; }), HasSubstr("gene 4 = 5")) << "a link to no block";
  EXPECT_THAT(fault_of([](Genome& g) { g[4] = 0.5f; }), HasSubstr("gene 4 = 0.5"));
  EXPECT_THAT(fault_of([](Genome& g) { g[4] = std::nanf(""); }), HasSubstr("gene 4 = not a number"));
  EXPECT_THAT(fault_of([](Genome& g) { g.blocks[1].id = g.blocks[0].id; }), HasSubstr("two blocks with the id"));
  EXPECT_THAT(fault_of([](Genome& g) { g.genes.pop_back(); }), HasSubstr("8 genes"));
  EXPECT_THAT(fault_of([](Genome& g) { g.blocks[0].type = 2; }), HasSubstr("type 2"));
  EXPECT_THAT(fault_of([](Genome& g) { g.blocks.clear(); }), HasSubstr("9 genes"));
  EXPECT_THAT(fault_of([](Genome& g) {
                for (std::uint32_t i = 0; i < 4; ++i) add_block(g, network(), node, std::vector<float>{0}, 70 + i);
              }),
              AllOf(HasSubstr("7 blocks of type \"node\""), HasSubstr("1 to 6")));
}

TEST(LayoutFault, NamesWhatIsWrong) {
  const auto fault_of = [](auto change) {
    Layout layout = network();
    change(layout);
    return layout_fault(layout);
  };
  EXPECT_EQ(layout_fault(network()), "");
  EXPECT_EQ(layout_fault(fixed()), "");
  EXPECT_THAT(fault_of([](Layout& l) { l.types[0].genes = {{1, -1}}; }), HasSubstr("1 to -1"));
  EXPECT_THAT(fault_of([](Layout& l) { l.types[1].genes[1].refers_to = 7; }), HasSubstr("type 7"));
  EXPECT_THAT(fault_of([](Layout& l) { l.types[0].most = 0; }), HasSubstr("1 to 0"));
  EXPECT_THAT(fault_of([](Layout& l) { l.types[0].least = 4; }), HasSubstr("3 blocks of type \"node\""));
  EXPECT_THAT(fault_of([](Layout& l) { l.types[1].name = "node"; }), HasSubstr("\"node\""));
  EXPECT_THAT(fault_of([](Layout& l) { l.types[1].name.clear(); }), HasSubstr("no name"));
  EXPECT_THAT(fault_of([](Layout& l) { l.types[1].genes.clear(); }), HasSubstr("no genes"));
}

/// Fixed genes, a network, and fixed genes again.
Layout three_sections() {
  Layout whole{.sections = {}};
  EXPECT_EQ(add_section(whole, "encoding", fixed()), 0u);
  EXPECT_EQ(add_section(whole, "devo", network()), 1u);
  EXPECT_EQ(add_section(whole, "mutation", fixed()), 2u);
  return whole;
}

TEST(Sections, AreJoinedAndSplit) {
  const Layout whole = three_sections();
  EXPECT_EQ(layout_fault(whole), "");
  EXPECT_FALSE(whole.is_fixed());
  const std::vector<Genome> parts = {Genome{0.5f, 1, 2}, chain(), Genome{0, 0.25f, 1}};
  const Genome genome = join(parts, whole);
  EXPECT_EQ(genome_fault(genome, whole), "");
  EXPECT_EQ(genome.size(), 15u);
  EXPECT_EQ(genome.blocks.size(), 2u + 5 + 2);
  EXPECT_EQ(split(genome, whole), parts);
}

TEST(Sections, ThatAreFixedStoreNoBlocks) {
  Layout whole{.sections = {}};
  for (const char* name : {"one", "other"}) add_section(whole, name, fixed());
  const Genome genome = join({Genome{0, 0, 0}, Genome{1, 1, 1}}, whole);
  EXPECT_TRUE(whole.is_fixed());
  EXPECT_TRUE(genome.blocks.empty());
  EXPECT_EQ(genome_fault(genome, whole), "");
  EXPECT_EQ(split(genome, whole).at(1), (Genome{1, 1, 1}));
}

TEST(Sections, ReachAnOperatorWithoutTheOthers) {
  const Layout whole = three_sections();
  const SectionIndices which{1, 2};
  const Layout part_layout = some_sections(whole, which, 2);
  EXPECT_THAT(part_layout.sections, ElementsAre("devo", "mutation"));
  EXPECT_EQ(part_layout.own, 1u);
  Genome genome = join({Genome{0.5f, 1, 2}, chain(), Genome{0, 0.25f, 1}}, whole);
  Genome part = part_of(genome, whole, which, part_layout);
  EXPECT_EQ(genome_fault(part, part_layout), "");
  EXPECT_EQ(part, join({chain(), Genome{0, 0.25f, 1}}, part_layout));
  EXPECT_THAT(std::vector(part_layout.own_genes(part).begin(), part_layout.own_genes(part).end()),
              ElementsAre(0, 0.25f, 1));

  // the network grows, and the operator's own genes behind it move on
  add_block(part, part_layout, 0, std::vector<float>{0.125f}, 77);
  part_layout.own_genes(part)[0] = 1;
  put_back(genome, whole, which, part, part_layout);
  EXPECT_EQ(genome_fault(genome, whole), "");
  const std::vector<Genome> parts = split(genome, whole);
  EXPECT_EQ(parts[0], (Genome{0.5f, 1, 2}));
  EXPECT_EQ(parts[1].size(), 10u);
  EXPECT_EQ(parts[2], (Genome{1, 0.25f, 1}));
}

TEST(Sections, HaveReferencesOfTheirOwn) {
  Layout whole{.sections = {}};
  for (const char* name : {"one", "other"}) add_section(whole, name, network());
  Genome genome = join({chain(), chain()}, whole);
  EXPECT_EQ(genome_fault(genome, whole), "") << "equal ids in two sections are no fault";
  EXPECT_EQ(target_of(genome, whole, genome.blocks[9], 2), 7u) << "node 2 of the second section";
  remove_block(genome, whole, 5);
  EXPECT_EQ(split(genome, whole).at(0), chain());
  EXPECT_THAT(split(genome, whole).at(1).genes, ElementsAre(-0.5f, 1.5f, -0.25f, 0, 1));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
