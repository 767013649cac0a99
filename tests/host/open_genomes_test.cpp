// Runs whose genomes gain and lose blocks and have several sections, which blocks come and go from parents to
// children, and parameters of every type.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "archive/archive.hpp"
#include "archive/recorded_experiment.hpp"
#include "base/genome_sections.hpp"
#include "evodevo/neat.hpp"
#include "experiment/toml_writer.hpp"
#include "report/genes_json.hpp"
#include "report/lineage.hpp"
#include "support/changed.hpp"
#include "support/experiments.hpp"
#include "support/lives.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"
#include "support/runs.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

/// The small experiment with a network that evolves, and a step size that evolves with it, and other changes.
std::string networks(const std::vector<std::pair<std::string, std::string>>& changes = {}) {
  const auto mutation = [](const std::string& name, const std::string& probability) {
    return "[[mutation]]\nname = \"" + name + "\"\nprobability = " + probability + "\n";
  };
  std::vector<std::pair<std::string, std::string>> all{
      {"name = \"voxel\"\nsize = [2, 1, 1]\nedge = 0.5\n", "name = \"neat\"\npoints = 20\nneighbours = 6\n"},
      {mutation("reset-weight", "0.8"), mutation("gaussian", "0.8") + mutation("add-node", "0.5") +
                                            mutation("add-link", "0.5") + mutation("remove-block", "0.3")},
      {"two-point", "uniform"}};
  all.insert(all.end(), changes.begin(), changes.end());
  return testing::small_with(all);
}

std::string complaint(const std::string& text) {
  return testing::refusal<ConfigError>([&] { testing::read(text); });
}

TEST(OpenGenomes, HaveASectionForEachOwnerAndAreToldByName) {
  const Experiment experiment = testing::read(networks());
  EXPECT_THAT(experiment.layout.sections, ::testing::ElementsAre("neat", "gaussian"));
  EXPECT_FALSE(experiment.layout.is_fixed());
  EXPECT_EQ(experiment.mutations[0].own_section, 1u);
  EXPECT_EQ(experiment.mutations[0].layout.own, 1u);
  EXPECT_EQ(experiment.mutations[1].layout.sections.size(), 1u) << "the step size is not seen by others";
  for (const Individual& individual : breed(experiment, {}, 0, 0, 10)) {
    EXPECT_EQ(genome_fault(individual.genome, experiment.layout), "");
    EXPECT_FLOAT_EQ(individual.genome.genes.back(), std::log(0.1f)) << "the step size";
  }
  const Individual individual = breed(experiment, {}, 0, 0, 1).front();
  const nlohmann::ordered_json sections = genes_json(individual.genome, experiment.layout);
  ASSERT_EQ(sections.size(), 2u);
  EXPECT_EQ(sections[0]["owner"], "neat");
  EXPECT_EQ(sections[0]["blocks"][0]["type"], "node");
  EXPECT_EQ(sections[0]["blocks"][0]["genes"]["bias"], individual.genome[0]);
  const auto& link = sections[0]["blocks"][12];
  EXPECT_EQ(link["type"], "link");
  EXPECT_EQ(link["genes"]["on"], "on");
  const std::span<const std::string> functions = experiment.layout.types[0].options(neat::function);
  EXPECT_EQ(sections[0]["blocks"][0]["genes"]["function"], functions[static_cast<std::size_t>(individual.genome[1])]);
  EXPECT_EQ(link["genes"]["from"], sections[0]["blocks"][0]["id"]);
  EXPECT_EQ(link["genes"]["to"], sections[0]["blocks"][4]["id"]);
  EXPECT_EQ(sections[1]["blocks"][0]["genes"]["ln(sigma)"], individual.genome.genes.back());
}

TEST(OpenGenomes, AreStoredAndResumedToTheBit) {
  const testing::Scratch scratch;
  const Experiment experiment = testing::read(networks(), {{"experiment.evaluations", "48", ""}});
  Archive whole = Archive::create(scratch / "whole", experiment, "test");
  testing::evolve_to(100, experiment, whole, 2);
  {
    Archive begun = Archive::create(scratch / "pieces", experiment, "test");
    testing::evolve_to(3, experiment, begun, 2);
  }
  Archive resumed = Archive::resume(scratch / "pieces");
  const Experiment recorded = recorded_experiment(resumed);
  EXPECT_EQ(recorded.layout, experiment.layout);
  EXPECT_EQ(resumed.layout(), experiment.layout);
  testing::evolve_to(100, recorded, resumed, 2);
  testing::expect_same_runs(whole, resumed);
  std::set<std::size_t> sizes;
  for (std::uint32_t id = 0; id < 48; ++id) {
    ASSERT_TRUE(whole.individual(id)) << id;
    EXPECT_EQ(genome_fault(whole.individual(id)->genome, experiment.layout), "") << id;
    sizes.insert(whole.individual(id)->genome.blocks.size());
  }
  EXPECT_GT(sizes.size(), 5u) << "blocks come and go";
}

TEST(OpenGenomes, OfOptionsWithoutNamesHaveTheirNumbers) {
  Layout own, layout{.sections = {}};
  own.add_block({{.choices = 3}, {.choices = 3}}, 3, "cell");
  own.types.back().gene_names = {"kind", "state"};
  own.types.back().name_options(1, {"young", "grown", "old"});
  add_section(layout, "x", own);
  const nlohmann::ordered_json genes = genes_json(Genome{2, 1, 0}, layout)[0]["blocks"][0]["genes"];
  EXPECT_EQ(genes["kind"], 2);
  EXPECT_EQ(genes["state 0"], "grown");
  EXPECT_EQ(genes["state 1"], "young");
}

TEST(OpenGenomes, OfBlocksWithoutNamesAreNumbered) {
  Layout own, layout{.sections = {}};
  own.add_block(3, {-1, 1});
  own.add_block({{-1, 1}, {-1, 1}}, "pair");
  own.add_block(4, {-2, 2}, "neuron");
  own.types.back().gene_names = {"bias", "weight"};
  add_section(layout, "x", own);
  const auto name = [&](std::size_t block, std::uint32_t gene) {
    return gene_name(layout.types[layout.first_blocks[block].type], layout.first_blocks[block], gene);
  };
  EXPECT_EQ(name(0, 0) + name(0, 2), "02");
  EXPECT_EQ(name(1, 1), "1");
  EXPECT_EQ(name(2, 0), "bias");
  EXPECT_EQ(name(2, 1), "weight 0");
  EXPECT_EQ(name(2, 3), "weight 2");
}

TEST(Sections, AreChosenByNameAndMustFitTheVariation) {
  const std::string mutation = "name = \"add-node\"\n";
  EXPECT_THAT(complaint(networks({{mutation, mutation + "sections = [\"neuron\"]\n"}})),
              testing::naming("mutation.1.sections", "neuron", "neat"));
  const Experiment experiment = testing::read(networks({{mutation, mutation + "sections = [\"neat\"]\n"}}));
  EXPECT_NE(experiment.resolved.find("sections = [ 'neat' ]"), std::string::npos) << experiment.resolved;
  EXPECT_THAT(complaint(testing::small_with({{"\"reset-weight\"", "\"add-node\""}})),
              testing::naming("mutation.0.name", "add-node", "\"node\"", "block_types", "voxel"));
}

TEST(Traits, FirstNetworksOfNeatMustFitItsLimits) {
  const auto limited = [](int more_materials, const std::string& keys) {
    std::string text = networks({{"name = \"neat\"\n", "name = \"neat\"\n" + keys + "\n"}});
    for (int i = 0; i < more_materials; ++i) text += "[materials.m" + std::to_string(i) + "]\nstiffness = 1000\n";
    return complaint(text);
  };
  EXPECT_EQ(limited(6, "nodes = 18\nlinks = 64"), "no refusal");  // 11 in all
  EXPECT_THAT(limited(6, "nodes = 17"),
              testing::naming("encoding", "`nodes` = 17", "at least 18", "4 inputs", "14 outputs"));
  EXPECT_THAT(limited(9, "links = 67"),
              testing::naming("encoding", "`links` = 67", "at least 68", "4 inputs", "17 outputs"));
}

// parameters ---------------------------------------------------------------------------------------------------------

/// One parameter of each type that the built-in operators do not use.
struct Holder {
  std::optional<double> rate;
  std::vector<double> levels = {1, 2};
  std::string motto = "none";
  InputFile cloud;
  Vec3 way{1, 0, 0};
  std::string aim;

  void declare(Parameters& p) {
    p.optional_real(rate, "rate", {0, 5, "1"}, "A rate that may be left out.");
    p.reals(levels, "levels", {-3, 3, "1"}, "Some levels.");
    p.text(motto, "motto", "A motto.");
    p.file(cloud, "cloud", "A cloud of points.");
    p.vector_or_choice(way, aim, "way", {-2, 2, "m"}, {"home", "away"}, "A way, or where it leads.");
  }
};

class NewParameters : public ::testing::Test {
 protected:
  Holder read(const std::string& text, const FileContents* recorded = nullptr) {
    const toml::table table = parse_toml(text, "x.toml");
    TomlReader reader(table, "t", {nullptr, scratch_ / "", recorded, &files_});
    Holder holder;
    holder.declare(reader);
    reader.finish();
    return holder;
  }
  std::string complaint_of(const std::string& text) {
    return testing::refusal<ConfigError>([&] { read(text); });
  }

  testing::Scratch scratch_;
  FileContents files_;
};

TEST_F(NewParameters, KeepTheirDefaultsOrAreReadAndWrittenBack) {
  const Holder unset = read("");
  EXPECT_FALSE(unset.rate.has_value());
  EXPECT_THAT(unset.levels, ::testing::ElementsAre(1, 2));
  EXPECT_EQ(unset.motto, "none");
  EXPECT_TRUE(unset.cloud.path.empty());
  EXPECT_TRUE(files_.empty());
  std::ofstream(scratch_ / "points.txt") << std::string("1 2 3\n\0", 7);
  Holder holder = read("rate = 2.5\nlevels = [-3, 0.5]\nmotto = \"so\"\ncloud = \"points.txt\"\nway = \"away\"");
  TomlWriter writer;
  holder.declare(writer);
  std::ostringstream text;
  text << writer.take();
  std::filesystem::remove(scratch_ / "points.txt");
  const Holder again = read(text.str(), &files_);
  EXPECT_EQ(again.rate, 2.5);
  EXPECT_THAT(again.levels, ::testing::ElementsAre(-3, 0.5));
  EXPECT_EQ(again.motto, "so");
  EXPECT_EQ(again.aim, "away");
  EXPECT_EQ(read("way = [0, -2, 1]").way, (Vec3{0, -2, 1}));
  EXPECT_EQ(read("way = [0, -2, 1]").aim, "");
  EXPECT_EQ(again.cloud.content, std::string("1 2 3\n\0", 7)) << "from the record, though the file is gone";
}

TEST_F(NewParameters, RefuseWhatDoesNotFit) {
  EXPECT_THAT(complaint_of("rate = 6"), testing::naming("t.rate = 6", "0 to 5"));
  EXPECT_THAT(complaint_of("levels = [1, 4]"), testing::naming("t.levels", "4", "-3 to 3"));
  EXPECT_THAT(complaint_of("levels = 1"), testing::naming("t.levels = 1", "list"));
  EXPECT_THAT(complaint_of("way = \"hom\""), testing::naming("t.way = \"hom\"", "home"));
  EXPECT_THAT(complaint_of("way = 3"), testing::naming("t.way = 3", "three numbers", "home, away"));
  EXPECT_THAT(complaint_of("way = [0, 3, 0]"), testing::naming("t.way = 3", "-2 to 2"));
  EXPECT_THAT(complaint_of("motto = 3"), testing::naming("t.motto = 3", "text"));
  EXPECT_THAT(complaint_of("cloud = \"points.txt\""), testing::naming("t.cloud", "points.txt"));
  EXPECT_THAT(complaint_of("cloud = \".\""), testing::naming("t.cloud", "folder"));
  const FileContents none;
  EXPECT_THROW(read("cloud = \"/etc/hostname\"", &none), ConfigError) << "a record reads no file of this machine";
}

using ::testing::ElementsAre;
using ::testing::IsEmpty;

struct Network {
  Layout layout;
  neat::Types types = neat::add_types(layout, 1, {"linear", "sine"}, 9, 9);
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
  child = network.parent;
  child[0] = 0.75F;
  EXPECT_THAT(block_changes(network.parent, child, network.layout), IsEmpty()) << "a gene is no block";
  EXPECT_EQ(changes_text({}, network.layout), "");
  Layout fixed;
  fixed.add_block(3, {-1, 1});
  EXPECT_THAT(block_changes({1, 0, 0}, {0, 0, 0}, fixed), IsEmpty()) << "where nothing comes or goes";
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
