// The border between host and plugin: what is refused, and in which words.
#include "loader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/scratch.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

/// Why the only library in tests/plugins' folder `fault` is refused.
std::string refusal(const std::string& fault, std::vector<fs::path> others_first = {}) {
  others_first.emplace_back(fs::path(EVODEVO_FAULTY_PLUGINS) / fault);
  const Registry registry(others_first);
  if (registry.failed().size() != 1) return std::to_string(registry.failed().size()) + " refusals";
  EXPECT_EQ(registry.failed()[0].file.parent_path().filename(), fault);
  return registry.failed()[0].reason;
}

const std::string remedy = "; rebuild the plugin against this evodevo with the same compiler";

TEST(Loader, ASoundLibraryIsUsed) {
  const Registry registry({fs::path(EVODEVO_FAULTY_PLUGINS) / "sound"});
  EXPECT_TRUE(registry.failed().empty());
  const AvailableOperator* nothing = registry.find("mutation", "nothing");
  ASSERT_NE(nothing, nullptr);
  EXPECT_EQ(registry.find("crossover", "nothing"), nullptr);
  EXPECT_STREQ(nothing->manifest->version, "1.0.0");
  EXPECT_NE(create<Mutation>(*nothing), nullptr);
}

TEST(Loader, LibrariesThatDoNotFit) {
  EXPECT_EQ(refusal("magic"), "its evodevo_plugin does not return an evodevo manifest; use EVODEVO_PLUGIN(...)");
  EXPECT_EQ(refusal("epoch"), "its ABI epoch is 99, this evodevo's is 1" + remedy);
  EXPECT_EQ(refusal("manifest_size"),
            "its manifest size is 8, this evodevo's is " + std::to_string(sizeof(PluginManifest)) + remedy);
  EXPECT_EQ(refusal("structs"),
            "its digest of struct sizes is 5, this evodevo's is " + std::to_string(plugin_struct_digest) + remedy);
  EXPECT_EQ(refusal("toolchain"),
            "its toolchain is another compiler, this evodevo's is " + std::string(plugin_toolchain) + remedy);
  EXPECT_EQ(refusal("switches"), "its list of build switches is -fpacked, this evodevo's is none" + remedy);
  EXPECT_EQ(refusal("no_entry"), "has no function evodevo_plugin; end one of its sources with EVODEVO_PLUGIN(...)");
  EXPECT_EQ(refusal("unknown_kind"), "its operator \"nothing\" is of the unknown kind \"wing\"");
}

TEST(Loader, ATakenNameIsRefusedWithBothFiles) {
  EXPECT_EQ(refusal("taken_name", {builtin_plugin_folder()}),
            "its mutation operator \"reset-weight\" is already brought by " +
                (builtin_plugin_folder() / "reset-weight.evodevo.so").string() + "; rename one of them");
}

TEST(Loader, AFileThatIsNoLibraryDisturbsNoOther) {
  const testing::Scratch scratch;
  scratch.write("text.evodevo.so", "this is no library");
  const Registry registry({scratch / "", fs::path(EVODEVO_FAULTY_PLUGINS) / "sound"});
  ASSERT_EQ(registry.failed().size(), 1u);
  EXPECT_THAT(registry.failed()[0].reason, ::testing::HasSubstr("cannot be loaded: "));
  EXPECT_THAT(registry.failed()[0].reason, ::testing::HasSubstr("text.evodevo.so"));
  EXPECT_NE(registry.find("mutation", "nothing"), nullptr);
}

TEST(Loader, AFolderThatIsNotThereIsNamed) {
  const Registry registry({"/no/such/folder"});
  ASSERT_EQ(registry.failed().size(), 1u);
  EXPECT_EQ(registry.failed()[0].file, "/no/such/folder");
  EXPECT_EQ(registry.failed()[0].reason, "the folder cannot be read: No such file or directory");
}

TEST(Loader, AllBuiltInOperatorsAreThere) {
  const Registry registry({builtin_plugin_folder()});
  EXPECT_TRUE(registry.failed().empty());
  using ::testing::ElementsAre;
  EXPECT_THAT(registry.names("encoding"), ElementsAre("cppn", "direct", "neural", "voxel"));
  EXPECT_THAT(registry.names("mutation"), ElementsAre("reset-weight"));
  EXPECT_THAT(registry.names("crossover"), ElementsAre("swap-neuron", "two-point"));
  EXPECT_THAT(registry.names("devo"),
              ElementsAre("amplitude-adaptation", "ballistic-growth", "length-adaptation", "mass-growth",
                          "mass-turnover", "spring-turnover", "stiffness-adaptation"));
  EXPECT_THAT(registry.names("fitness"), ElementsAre("actuation-work", "distance"));
  EXPECT_THAT(registry.names("selection"), ElementsAre("age-fitness-pareto", "elitist", "pareto-layers"));
}

}  // namespace
}  // namespace evodevo
