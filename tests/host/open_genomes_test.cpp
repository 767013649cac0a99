// Runs whose genomes gain and lose blocks and have several sections, and parameters of every type.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "base/genome_sections.hpp"
#include "evolution/archive/archive.hpp"
#include "evolution/breeding.hpp"
#include "evolution/evolution.hpp"
#include "experiment/toml_writer.hpp"
#include "report/genes_json.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

std::string replaced(std::string text, const std::string& old, const std::string& by) {
  return text.replace(text.find(old), old.size(), by);
}

/// The small experiment with a network that evolves, and a step size that evolves with it.
std::string networks() {
  std::string text = replaced(testing::small_experiment, "name = \"voxel\"\nsize = [2, 1, 1]\nedge = 0.5\n",
                              "name = \"neat\"\npoints = 20\nneighbours = 6\n");
  text = replaced(text, "name = \"reset-weight\"\nprobability = 0.8\n",
                  "name = \"gaussian\"\nprobability = 0.8\n[[mutation]]\nname = \"add-node\"\nprobability = 0.5\n"
                  "[[mutation]]\nname = \"add-link\"\nprobability = 0.5\n[[mutation]]\nname = \"remove-block\"\n"
                  "probability = 0.3\n");
  return replaced(text, "two-point", "uniform");
}

std::string complaint(const std::string& text) {
  try {
    testing::read(text);
    return "accepted";
  } catch (const ConfigError& error) {
    return error.what();
  }
}

void evolve_until(const Experiment& experiment, Archive& archive, std::uint32_t generations) {
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 2);
  std::atomic<bool> stop = false;
  const Observer observer{[&](const Summary& summary) { stop = summary.generation + 1 >= generations; }, [](double) {}};
  evolve(experiment, *simulator, archive, stop, observer);
}

TEST(OpenGenomes, HaveASectionForEachOwner) {
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
}

TEST(OpenGenomes, AreStoredAndResumedToTheBit) {
  const testing::Scratch scratch;
  const Experiment experiment = testing::read(networks(), {{"experiment.evaluations", "48", ""}});
  Archive whole = Archive::create(scratch / "whole", experiment, "test");
  evolve_until(experiment, whole, 100);
  {
    Archive begun = Archive::create(scratch / "pieces", experiment, "test");
    evolve_until(experiment, begun, 3);
  }
  Archive resumed = Archive::resume(scratch / "pieces");
  const Experiment recorded = recorded_experiment(resumed);
  EXPECT_EQ(recorded.layout, experiment.layout);
  EXPECT_EQ(resumed.layout(), experiment.layout);
  evolve_until(recorded, resumed, 100);
  std::set<std::size_t> sizes;
  for (std::uint32_t id = 0; id < 48; ++id) {
    ASSERT_TRUE(whole.individual(id) && resumed.individual(id)) << id;
    EXPECT_EQ(resumed.individual(id)->genome, whole.individual(id)->genome) << id;
    EXPECT_EQ(resumed.individual(id)->result.objectives, whole.individual(id)->result.objectives) << id;
    EXPECT_EQ(genome_fault(whole.individual(id)->genome, experiment.layout), "") << id;
    sizes.insert(whole.individual(id)->genome.blocks.size());
  }
  EXPECT_GT(sizes.size(), 5u) << "blocks come and go";
}

TEST(OpenGenomes, AreToldByName) {
  const Experiment experiment = testing::read(networks());
  const Individual individual = breed(experiment, {}, 0, 0, 1).front();
  const nlohmann::ordered_json sections = genes_json(individual.genome, experiment.layout);
  ASSERT_EQ(sections.size(), 2u);
  EXPECT_EQ(sections[0]["owner"], "neat");
  EXPECT_EQ(sections[0]["blocks"][0]["type"], "node");
  EXPECT_EQ(sections[0]["blocks"][0]["genes"]["bias"], individual.genome[0]);
  const auto& link = sections[0]["blocks"][12];
  EXPECT_EQ(link["type"], "link");
  EXPECT_EQ(link["genes"]["on"], 1);
  EXPECT_EQ(link["genes"]["from"], sections[0]["blocks"][0]["id"]);
  EXPECT_EQ(link["genes"]["to"], sections[0]["blocks"][4]["id"]);
  EXPECT_EQ(sections[1]["blocks"][0]["genes"]["ln(sigma)"], individual.genome.genes.back());
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

TEST(Sections, AreChosenByName) {
  const std::string mutation = "name = \"add-node\"\n";
  EXPECT_EQ(complaint(replaced(networks(), mutation, mutation + "sections = [\"neat\"]\n")), "accepted");
  EXPECT_THAT(complaint(replaced(networks(), mutation, mutation + "sections = [\"neuron\"]\n")),
              testing::naming("mutation.1.sections", "neuron", "neat"));
  const Experiment experiment = testing::read(replaced(networks(), mutation, mutation + "sections = [\"neat\"]\n"));
  EXPECT_NE(experiment.resolved.find("sections = [ 'neat' ]"), std::string::npos) << experiment.resolved;
}

TEST(Traits, OfVariationMustFitTheGenomes) {
  EXPECT_THAT(complaint(replaced(testing::small_experiment, "\"reset-weight\"", "\"add-node\"")),
              testing::naming("mutation.0.name", "add-node", "\"node\"", "block_types", "voxel"));
}

TEST(Traits, FirstNetworksOfNeatMustFitItsLimits) {
  std::string text = networks();
  for (int i = 0; i < 6; ++i) text += "[materials.m" + std::to_string(i) + "]\nstiffness = 1000\n";  // 11 in all
  const auto limited = [&](const std::string& keys) {
    return complaint(replaced(text, "name = \"neat\"\n", "name = \"neat\"\n" + keys + "\n"));
  };
  EXPECT_EQ(limited("nodes = 18\nlinks = 64"), "accepted");
  EXPECT_THAT(limited("nodes = 17"),
              testing::naming("encoding", "`nodes` = 17", "at least 18", "4 inputs", "14 outputs"));
  text += "[materials.m6]\nstiffness = 1000\n[materials.m7]\nstiffness = 1000\n[materials.m8]\nstiffness = 1000\n";
  EXPECT_THAT(limited("links = 67"),
              testing::naming("encoding", "`links` = 67", "at least 68", "4 inputs", "17 outputs"));
}

// parameters ---------------------------------------------------------------------------------------------------------

/// One parameter of each type that the built-in operators do not use.
struct Holder {
  std::optional<double> rate;
  std::vector<double> levels = {1, 2};
  std::string motto = "none";
  InputFile cloud;

  void declare(Parameters& p) {
    p.optional_real(rate, "rate", {0, 5, "1"}, "A rate that may be left out.");
    p.reals(levels, "levels", {-3, 3, "1"}, "Some levels.");
    p.text(motto, "motto", "A motto.");
    p.file(cloud, "cloud", "A cloud of points.");
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
    try {
      read(text);
      return "accepted";
    } catch (const ConfigError& error) {
      return error.what();
    }
  }

  testing::Scratch scratch_;
  FileContents files_;
};

TEST_F(NewParameters, KeepTheirDefaults) {
  const Holder holder = read("");
  EXPECT_FALSE(holder.rate.has_value());
  EXPECT_THAT(holder.levels, ::testing::ElementsAre(1, 2));
  EXPECT_EQ(holder.motto, "none");
  EXPECT_TRUE(holder.cloud.path.empty());
  EXPECT_TRUE(files_.empty());
}

TEST_F(NewParameters, AreReadAndWrittenBack) {
  std::ofstream(scratch_ / "points.txt") << std::string("1 2 3\n\0", 7);
  Holder holder = read("rate = 2.5\nlevels = [-3, 0.5]\nmotto = \"so\"\ncloud = \"points.txt\"");
  EXPECT_EQ(holder.rate, 2.5);
  EXPECT_THAT(holder.levels, ::testing::ElementsAre(-3, 0.5));
  EXPECT_EQ(holder.motto, "so");
  EXPECT_EQ(holder.cloud.content, std::string("1 2 3\n\0", 7));
  EXPECT_EQ(files_.at("points.txt"), holder.cloud.content);
  TomlWriter writer;
  holder.declare(writer);
  std::ostringstream text;
  text << writer.take();
  std::filesystem::remove(scratch_ / "points.txt");
  const Holder again = read(text.str(), &files_);
  EXPECT_EQ(again.rate, holder.rate);
  EXPECT_EQ(again.levels, holder.levels);
  EXPECT_EQ(again.motto, holder.motto);
  EXPECT_EQ(again.cloud.content, holder.cloud.content) << "from the record, though the file is gone";
}

TEST_F(NewParameters, RefuseWhatDoesNotFit) {
  EXPECT_THAT(complaint_of("rate = 6"), testing::naming("t.rate = 6", "0 to 5"));
  EXPECT_THAT(complaint_of("levels = [1, 4]"), testing::naming("t.levels", "4", "-3 to 3"));
  EXPECT_THAT(complaint_of("levels = 1"), testing::naming("t.levels = 1", "list"));
  EXPECT_THAT(complaint_of("motto = 3"), testing::naming("t.motto = 3", "text"));
  EXPECT_THAT(complaint_of("cloud = \"points.txt\""), testing::naming("t.cloud", "points.txt"));
  EXPECT_THAT(complaint_of("cloud = \".\""), testing::naming("t.cloud", "folder"));
  const FileContents none;
  EXPECT_THROW(read("cloud = \"/etc/hostname\"", &none), ConfigError) << "a record reads no file of this machine";
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
