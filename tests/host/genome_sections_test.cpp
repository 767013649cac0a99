// Genomes whose blocks come and go, and genomes of several sections.
#include "base/genome_sections.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
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

// moving, inserting and grafting ------------------------------------------------------------------------------------

/// Two sections like network() with more room, each of which also has items that refer to items.
Layout two_networks() {
  Layout one = network();
  one.types[node].most = one.types[link].most = 6;
  one.add_type({.name = "item", .genes = {{0, 1}, {.refers_to = 2}}, .most = 6});
  for (int i = 0; i < 4; ++i) one.add_block_of(2);
  Layout whole{.sections = {}};
  for (const char* name : {"one", "other"}) add_section(whole, name, one);
  return whole;
}

/// A block apart from its place: its section, its type, and its genes, with ids in place of references.
struct Meaning {
  std::uint32_t section, type;
  std::vector<double> values;
  std::vector<BlockId> targets;

  bool operator==(const Meaning&) const = default;
};

/// The blocks of a genome by section and id. The same graph says the same, whatever the order of blocks.
using Graph = std::map<std::pair<std::uint32_t, BlockId>, Meaning>;

Graph graph_of(const Genome& genome, const Layout& layout) {
  Graph graph;
  for (const Block& block : layout.blocks(genome)) {
    const BlockType& type = layout.types[block.type];
    Meaning& meaning = graph[{type.section, block.id}] = {type.section, block.type, {}, {}};
    for (std::uint32_t gene = 0; gene < block.count; ++gene)
      if (type.gene(gene).is_reference())
        meaning.targets.push_back(layout.blocks(genome)[target_of(genome, layout, block, gene)].id);
      else
        meaning.values.push_back(genome[block.first + gene]);
  }
  return graph;
}

/// Returns a part of a graph that is closed: with each key, those that `others_of(graph, key)` returns.
template <class Others>
std::set<Graph::key_type> closure(const Graph& graph, std::set<Graph::key_type> keys, const Others& others_of) {
  for (std::size_t before = 0; before != keys.size();) {
    before = keys.size();
    for (const auto& key : std::set(keys))
      for (const auto& other : others_of(graph, key)) keys.insert(other);
  }
  return keys;
}

std::set<Graph::key_type> that_refer_to(const Graph& graph, const Graph::key_type& key) {
  std::set<Graph::key_type> found;
  for (const auto& [other, meaning] : graph)
    if (other.first == key.first && std::ranges::count(meaning.targets, key.second) > 0) found.insert(other);
  return found;
}

/// Changes a genome at random: blocks go and come, with values of their own.
Genome varied(Genome genome, const Layout& layout, Rng& rng, int times) {
  for (int i = 0; i < times; ++i) {
    Genome changed = genome;
    if (rng.chance(0.4)) {
      remove_block(changed, layout, rng.below(static_cast<std::uint32_t>(genome.blocks.size())));
    } else {
      const std::uint32_t type = rng.below(static_cast<std::uint32_t>(layout.types.size()));
      const std::vector<float> genes(layout.types[type].genes.size());
      const Block block = changed.blocks[add_block(changed, layout, type, genes, fresh_id(rng))];
      for (std::uint32_t gene = block.first; gene < block.first + block.count; ++gene)
        changed[gene] = layout.draw(changed, gene, rng);
    }
    if (is_within_limits(changed, layout)) genome = changed;
  }
  return genome;
}

std::uint32_t any_block(const Genome& genome, Rng& rng) {
  return rng.below(static_cast<std::uint32_t>(genome.blocks.size()));
}

TEST(Blocks, GoTogetherWithAllThatRefersToThem) {
  const Layout layout = two_networks();
  Rng rng = stream(11);
  std::set<std::size_t> sizes;
  for (int i = 0; i < 300; ++i) {
    Genome genome = varied(random_genome(layout, rng), layout, rng, 20);
    const std::uint32_t block = any_block(genome, rng);
    Graph graph = graph_of(genome, layout);
    const Graph::key_type key{layout.types[genome.blocks[block].type].section, genome.blocks[block].id};
    const auto together = closure(graph, {key}, that_refer_to);
    std::set<Graph::key_type> found;
    for (const std::uint32_t one : referring_blocks(genome, layout, block))
      EXPECT_TRUE(found.emplace(key.first, genome.blocks[one].id).second) << "a block comes twice";
    ASSERT_EQ(found, together) << i;
    sizes.insert(together.size());
    remove_block(genome, layout, block);
    for (const auto& gone : together) graph.erase(gone);
    ASSERT_EQ(graph_of(genome, layout), graph) << i;
  }
  EXPECT_GT(sizes.size(), 4u);
}

TEST(Blocks, MoveWithinTheirSectionAndKeepTheirMeaning) {
  const Layout layout = two_networks();
  Rng rng = stream(12);
  int moved = 0;
  for (int i = 0; i < 400; ++i) {
    const Genome before = varied(random_genome(layout, rng), layout, rng, 15);
    const std::uint32_t block = any_block(before, rng), place = any_block(before, rng);
    const auto section = [&](std::uint32_t one) { return layout.types[before.blocks[one].type].section; };
    Genome genome = before;
    ASSERT_EQ(move_block(genome, layout, block, place), section(block) == section(place));
    if (section(block) != section(place)) {
      ASSERT_EQ(genome, before);
      continue;
    }
    ++moved;
    std::vector<BlockId> order, expected;
    for (const Block& one : genome.blocks) order.push_back(one.id);
    for (const Block& one : before.blocks) expected.push_back(one.id);
    const BlockId id = expected[block];
    expected.erase(expected.begin() + block);
    expected.insert(expected.begin() + place, id);
    ASSERT_EQ(order, expected) << block << " to " << place;
    ASSERT_EQ(genome_fault(genome, layout), "");
    ASSERT_EQ(graph_of(genome, layout), graph_of(before, layout));
    ASSERT_TRUE(move_block(genome, layout, place, block));
    ASSERT_EQ(genome, before) << "there and back";
  }
  EXPECT_GT(moved, 100);
}

TEST(Blocks, OfFixedSectionsDoNotMove) {
  Genome one{0.5f, 1, 2};
  EXPECT_FALSE(move_block(one, fixed(), 0, 1));
  EXPECT_EQ(one, (Genome{0.5f, 1, 2}));
  Layout whole{.sections = {}};
  add_section(whole, "encoding", fixed());
  add_section(whole, "devo", network());
  Genome genome = join({Genome{0.5f, 1, 2}, chain()}, whole);
  const Genome before = genome;
  EXPECT_FALSE(move_block(genome, whole, 0, 1)) << "the archive does not store the order of such blocks";
  EXPECT_FALSE(move_block(genome, whole, 2, 99)) << "there is no such place";
  EXPECT_EQ(genome, before);
  EXPECT_TRUE(move_block(genome, whole, 2, 6));
  EXPECT_THAT(split(genome, whole).at(1).genes, ElementsAre(-0.5f, 1.5f, 0.25f, 4, 0, -0.25f, 0, 1, 0.5f));
}

TEST(Blocks, AreInsertedWhereTheirReferencesHaveTargets) {
  const Layout layout = network();
  Genome from = chain(), to = chain();
  add_block(from, layout, node, std::vector{0.75f}, 77);
  add_block(from, layout, link, std::vector<float>{-0.5f, 5, 1}, 88);  // from the new node to node 1
  move_block(to, layout, 1, 0);                                        // where node 1 is block 0
  const Genome before = to;
  EXPECT_EQ(insert_block(to, from, 6, layout), std::nullopt) << "its node is not there";
  EXPECT_EQ(to, before);
  EXPECT_EQ(insert_block(to, from, 5, layout), 5u);
  EXPECT_EQ(insert_block(to, from, 6, layout), 6u);
  EXPECT_EQ(to.blocks.back().id, 88u);
  EXPECT_THAT(std::vector(to.begin() + 10, to.end()), ElementsAre(-0.5f, 5, 0));
  EXPECT_EQ(insert_block(to, from, 6, layout), std::nullopt) << "it is there already";
  EXPECT_EQ(insert_block(to, from, 6, layout, 99), 7u) << "under another id";
  EXPECT_EQ(to.blocks.back().id, 99u);
  EXPECT_EQ(genome_fault(to, layout), "");
  Layout narrow = layout;
  narrow.types[link].most = 4;
  const Genome full = to;
  EXPECT_EQ(insert_block(to, from, 6, narrow, 100), std::nullopt) << "there are four links";
  EXPECT_EQ(to, full);
  to.blocks[5].type = link;  // nothing that evolution makes: the id is that of a block of another type
  EXPECT_EQ(insert_block(to, from, 6, layout, 101), std::nullopt);
  Genome four{0.5f, 1, 2};
  EXPECT_EQ(insert_block(four, {0.25f, 0, 1}, 0, fixed()), std::nullopt);
  EXPECT_EQ(four, (Genome{0.5f, 1, 2}));
}

TEST(Blocks, AreInsertedTogetherUnderNewIds) {
  const Layout layout = network();
  Genome genome = chain();
  const std::vector<std::uint32_t> part = referring_blocks(genome, layout, 1);
  ASSERT_THAT(part, ElementsAre(1, 3, 4));
  EXPECT_EQ(insert_blocks(genome, genome, part, layout), std::nullopt) << "their ids are taken";
  const BlockId ids[] = {70, 71, 72};
  EXPECT_THAT(insert_blocks(genome, genome, part, layout, ids).value(), ElementsAre(5, 6, 7));
  // links from node 0 to the copy of node 1, and from the copy to node 2
  EXPECT_THAT(genome.genes,
              ElementsAre(0.5f, -0.5f, 1.5f, 0.25f, 0, 1, -0.25f, 1, 2, -0.5f, 0.25f, 0, 5, -0.25f, 5, 2));
  EXPECT_EQ(genome_fault(genome, layout), "");
}

TEST(Blocks, AreGraftedWithAllThatTheyNeed) {
  const Layout layout = two_networks();
  Rng rng = stream(13);
  int grafted = 0, refused = 0, nothing = 0;
  for (int i = 0; i < 600; ++i) {
    const Genome ancestor = varied(random_genome(layout, rng), layout, rng, 15);
    const Genome from = varied(ancestor, layout, rng, 10);
    Genome to = varied(ancestor, layout, rng, 10);
    const std::uint32_t block = any_block(from, rng);
    const Graph theirs = graph_of(from, layout);
    Graph expected = graph_of(to, layout);
    const Graph::key_type key{layout.types[from.blocks[block].type].section, from.blocks[block].id};
    const auto needed_for = [&](const Graph& graph, const Graph::key_type& one) {
      std::set<Graph::key_type> needed;
      if (!expected.contains(one))
        for (const BlockId target : graph.at(one).targets) needed.emplace(one.first, target);
      return needed;
    };
    std::set<Graph::key_type> added;
    for (const auto& one : closure(theirs, closure(theirs, {key}, that_refer_to), needed_for))
      if (!expected.contains(one)) added.insert(one);
    for (const auto& one : added) expected[one] = theirs.at(one);
    const Genome before = to;
    const auto copies = graft_block(to, from, block, layout);
    if (!copies) {
      ++refused;
      ASSERT_EQ(to, before);
      std::map<std::uint32_t, std::uint32_t> counts;
      for (const auto& [one, meaning] : expected) ++counts[meaning.type];
      ASSERT_TRUE(std::ranges::any_of(counts, [&](auto count) {
        return count.second > layout.types[count.first].most;
      })) << "there is room for all";
      continue;
    }
    (added.empty() ? nothing : grafted) += 1;
    std::set<Graph::key_type> found;
    for (const std::uint32_t copy : *copies) found.emplace(key.first, to.blocks[copy].id);
    ASSERT_EQ(found, added) << i;
    ASSERT_EQ(graph_of(to, layout), expected) << i;
    ASSERT_EQ(genome_fault(to, layout), "") << i;
    ASSERT_TRUE(graft_block(to, from, block, layout)->empty()) << "nothing is left to graft";
  }
  EXPECT_GT(grafted, 50);
  EXPECT_GT(refused, 5);
  EXPECT_GT(nothing, 50);
  Genome same{0.5f, 1, 2};
  EXPECT_TRUE(graft_block(same, {0.25f, 0, 1}, 0, fixed())->empty()) << "all genomes have all blocks";
  EXPECT_EQ(same, (Genome{0.5f, 1, 2}));
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

TEST(LayoutFault, NamesOptionsThatAreNotThoseOfTheGene) {
  const auto fault_of = [](std::size_t gene, std::vector<std::string> names) {
    Layout layout;
    layout.add_block({{0, 1}, {.choices = 2}}, 5, "cell");  // the second gene describes four
    layout.types[0].name_options(gene, std::move(names));
    return layout_fault(layout);
  };
  EXPECT_EQ(fault_of(1, {"off", "on"}), "");
  EXPECT_EQ(fault_of(1, {}), "");
  EXPECT_THAT(fault_of(1, {"off"}), AllOf(HasSubstr("\"cell\", gene 1"), HasSubstr("names 1 option"), HasSubstr("2")));
  EXPECT_THAT(fault_of(0, {"off", "on"}), AllOf(HasSubstr("gene 0"), HasSubstr("2 options"), HasSubstr("has 0")));
  EXPECT_THAT(fault_of(2, {"off", "on"}), AllOf(HasSubstr("\"cell\""), HasSubstr("3 genes"), HasSubstr("has 2")));
  EXPECT_THAT(fault_of(1, {"on", "on"}), AllOf(HasSubstr("gene 1"), HasSubstr("two options"), HasSubstr("\"on\"")));
  EXPECT_THAT(fault_of(1, {"", "on"}), AllOf(HasSubstr("gene 1"), HasSubstr("without a name")));
  EXPECT_THAT(fault_of(1, {"o\nff", "on"}), AllOf(HasSubstr("gene 1"), HasSubstr("control characters")));
}

TEST(Options, OfTheLastGeneAreThoseOfAllFurtherOnes) {
  Layout own, layout{.sections = {}};
  own.add_block({{0, 1}, {.choices = 2}}, 5, "cell");
  own.types[0].name_options(1, {"off", "on"});
  own.types[0].gene_names = {"size", "first", "second"};  // more names than descriptions
  add_section(layout, "x", own);
  for (const Layout& one : {own, layout, some_sections(layout, {0})}) {
    EXPECT_TRUE(one.types[0].options(0).empty());
    for (const std::size_t gene : {1, 2, 4})
      EXPECT_THAT(std::vector(one.types[0].options(gene).begin(), one.types[0].options(gene).end()),
                  ElementsAre("off", "on"))
          << gene;
    EXPECT_EQ(layout_fault(one), "");
  }
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
