// The border between host and plugins: which libraries are refused, and with which messages.
#include "operators/loader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cfenv>

#include "operators/declarations.hpp"
#include "support/scratch.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

/// Returns the message with which the only library in tests/plugins' folder `fault` is refused.
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
  EXPECT_EQ(refusal("epoch"), "its ABI epoch is 99, this evodevo's is " + std::to_string(plugin_epoch) + remedy);
  EXPECT_EQ(refusal("manifest_size"),
            "its manifest size is 8, this evodevo's is " + std::to_string(sizeof(PluginManifest)) + remedy);
  EXPECT_EQ(refusal("structs"),
            "its digest of struct sizes is 5, this evodevo's is " + std::to_string(plugin_struct_digest) + remedy);
  EXPECT_EQ(refusal("toolchain"),
            "its toolchain is another compiler, this evodevo's is " + std::string(plugin_toolchain) + remedy);
  EXPECT_EQ(refusal("switches"), "its list of build switches is -fpacked, this evodevo's is none" + remedy);
  EXPECT_EQ(refusal("no_entry"), "has no function evodevo_plugin; end one of its sources with EVODEVO_PLUGIN(...)");
  EXPECT_EQ(refusal("unknown_kind"),
            "its operator \"nothing\" is of the unknown kind \"wing\"; rebuild the plugin against this evodevo");
  EXPECT_EQ(refusal("twin"), "its mutation operator \"nothing\" is in it twice; rename one of them");
  EXPECT_EQ(refusal("default"),
            "its mutation operator \"nothing\" has a default that it does not allow: genes = 7, expected 0 to 5; "
            "correct the default or the range");
  EXPECT_EQ(refusal("constructor"),
            "its mutation operator \"nothing\" cannot be made: \"no licence\"; its constructor and parameters() must "
            "not throw");
}

TEST(Loader, TextsThatDisturbATerminalAreRefused) {
  const std::string fault = " is not at most 300 bytes of UTF-8 without control characters; correct it";
  EXPECT_EQ(refusal("controls_in_name"), "the name of its mutation operator \"noth\\x1b[31ming\"" + fault);
  EXPECT_EQ(refusal("controls_in_summary"),
            "the summary of its mutation operator \"nothing\" \"Changes\\nnothing.\"" + fault);
  EXPECT_EQ(refusal("controls_in_version"), "its version \"1.0\\x07\"" + fault);
}

TEST(Loader, OnlyFilesAreLoaded) {
  const testing::Scratch scratch;
  fs::create_directory(scratch / "folder.evodevo.so");
  fs::create_symlink("/dev/zero", scratch / "zero.evodevo.so");
  ASSERT_EQ(mkfifo((scratch / "pipe.evodevo.so").c_str(), 0600), 0);
  const Registry registry({scratch / ""});
  EXPECT_EQ(registry.failed().size(), 3u);
  for (const FailedLibrary& failed : registry.failed()) EXPECT_THAT(failed.reason, ::testing::StartsWith("is no file"));
}

TEST(Loader, WhatAManifestLacksIsNamedAndDisturbsNoOther) {
  const std::pair<const char*, const char*> faults[] = {
      {"null_kind", "its operator 0: the kind is missing"},
      {"null_name", "its operator 0: the name is missing"},
      {"empty_name", "its operator 0: the name is missing"},
      {"null_summary", "its operator 0: the summary is missing"},
      {"null_create", "its operator 0: it has no function that creates it"},
      {"creates_null", "its mutation operator \"nothing\" is no object of the class of this kind"},
      {"other_class", "its devo operator \"nothing\" is no object of the class of this kind"},
      {"null_toolchain", "its toolchain is nothing, this evodevo's is "},
      {"null_version", "its version is missing"},
      {"null_entries", "it has no list of operators"},
      {"constructor_throws_a_number",
       "its mutation operator \"nothing\" cannot be made: \"it threw something that is no std::exception\""},
      {"static_throws", "crashes while it is loaded: "}};
  std::vector<fs::path> all;
  for (const auto& [fault, reason] : faults) {
    EXPECT_THAT(refusal(fault), ::testing::StartsWith(reason)) << fault;
    EXPECT_THAT(refusal(fault), ::testing::HasSubstr("; ")) << fault << " lacks a remedy";
    all.emplace_back(fs::path(EVODEVO_FAULTY_PLUGINS) / fault);
  }
  all.emplace_back(fs::path(EVODEVO_FAULTY_PLUGINS) / "sound");
  const Registry registry(all);
  EXPECT_EQ(registry.failed().size(), std::size(faults));
  EXPECT_NE(registry.find("mutation", "nothing"), nullptr) << "of the sound library, which came last";
}

/// An operator with one parameter of the given name.
struct Named final : Operator {
  std::string name;
  double value = 1;
  void parameters(Parameters& p) override { p.real(value, name, {0, 1, "1"}, "A parameter of any name."); }
};

TEST(Loader, NoParameterTakesAKeyOfTheHost) {
  EXPECT_THAT(refusal("reserved"),
              ::testing::StartsWith("its mutation operator \"nothing\" calls a parameter \"every\", which is a key of "
                                    "the host's own in every operator's table; rename"));
  Named op;
  for (const char* key : {"name", "mass", "probability", "from", "to", "every", "label", "over"}) {
    op.name = key;
    EXPECT_EQ(taken_name(op), key);
  }
  op.name = "masses";
  EXPECT_EQ(taken_name(op), "");
}

TEST(Loader, WhatALibraryChangesWhileItIsLoadedIsPutBackAndNamed) {
  ASSERT_EQ(std::fegetround(), FE_TONEAREST);
  ::testing::internal::CaptureStderr();
  const Registry registry({fs::path(EVODEVO_FAULTY_PLUGINS) / "rounds"});
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_EQ(std::fegetround(), FE_TONEAREST);
  EXPECT_NE(registry.find("mutation", "nothing"), nullptr) << "it is used";
  EXPECT_THAT(said, ::testing::HasSubstr("rounds/plugin.evodevo.so: it changed the rounding mode, which has been put"));
}

TEST(Loader, ALibraryThatLacksASymbolIsRefusedWithItsName) {
  EXPECT_THAT(refusal("undefined_symbol"), ::testing::MatchesRegex("cannot be loaded: .*undefined symbol.*nobody.*"));
  EXPECT_THAT(refusal("undefined_symbol"),
              ::testing::EndsWith("; link it with all that it uses (-Wl,-z,defs tells what "
                                  "is missing)"));
}

TEST(Loader, TheEntryOfALinkedLibraryIsNotItsOwn) {
  EXPECT_EQ(refusal("borrowed_entry"), "has no function evodevo_plugin of its own, only that of " +
                                           (fs::path(EVODEVO_FAULTY_PLUGINS) / "sound/plugin.evodevo.so").string() +
                                           " which it links; end one of its sources with EVODEVO_PLUGIN(...)");
}

TEST(Loader, ALibraryThatCrashesIsRefusedAndDisturbsNoOther) {
  const std::string look = "; look at its static objects, constructors and parameters() in a debugger, or remove it";
  const fs::path sound = fs::path(EVODEVO_FAULTY_PLUGINS) / "sound";
  EXPECT_EQ(refusal("crash", {sound}), "crashes while it is loaded: Segmentation fault" + look);
  EXPECT_EQ(refusal("exit", {sound}), "crashes while it is loaded: it ended the process with exit code 3" + look);
  const testing::Scratch scratch;
  fs::copy_file(fs::path(EVODEVO_FAULTY_PLUGINS) / "crash/plugin.evodevo.so", scratch / "a.evodevo.so");
  fs::copy_file(sound / "plugin.evodevo.so", scratch / "b.evodevo.so");
  const Registry registry({scratch / ""});
  EXPECT_NE(registry.find("mutation", "nothing"), nullptr) << "in the same folder, behind the one that crashes";
}

TEST(Loader, ALibraryThatTwoPathsLeadToIsLoadedOnce) {
  const fs::path folder = fs::path(EVODEVO_FAULTY_PLUGINS) / "sound";
  const Registry registry({folder, folder / ".", folder / "plugin.evodevo.so"});
  EXPECT_TRUE(registry.failed().empty());
  EXPECT_EQ(registry.operators().size(), 1u);
}

TEST(Loader, WhereOperatorsAreLookedFor) {
  setenv("EVODEVO_PLUGIN_PATH", "/one::/two", 1);
  EXPECT_THAT(plugin_search_path({"/mine"}), ::testing::ElementsAre("/mine", "/one", "/two", builtin_plugin_folder()));
  unsetenv("EVODEVO_PLUGIN_PATH");
  EXPECT_THAT(plugin_search_path({}), ::testing::ElementsAre(builtin_plugin_folder()));
}

TEST(Loader, AnotherBuildHasAnotherHash) {
  const fs::path folder(EVODEVO_FAULTY_PLUGINS);
  const auto hash = [&](const char* name) { return file_hash(folder / name / "plugin.evodevo.so"); };
  EXPECT_EQ(hash("sound"), hash("sound"));
  EXPECT_NE(hash("sound"), hash("newer"));
}

TEST(Loader, OfTwoLibrariesWithOneNameTheSecondIsRefusedWithBothFiles) {
  const fs::path own = fs::path(EVODEVO_FAULTY_PLUGINS) / "taken_name";
  const fs::path built_in = builtin_plugin_folder() / "reset-weight.evodevo.so";
  const auto twin = [](const fs::path& first) {
    return "its mutation operator \"reset-weight\" is already brought by " + first.string() +
           ", which comes first; rename one of them, or take one off the plugin path";
  };
  EXPECT_EQ(refusal("taken_name", {builtin_plugin_folder()}), twin(built_in));
  const Registry registry({own, builtin_plugin_folder()});
  ASSERT_EQ(registry.failed().size(), 1u);
  EXPECT_EQ(registry.failed()[0].file, built_in);
  EXPECT_EQ(registry.failed()[0].reason, twin(own / "plugin.evodevo.so"));
  EXPECT_EQ(registry.find("mutation", "reset-weight")->file, own / "plugin.evodevo.so");
}

TEST(Loader, AFileThatIsNoLibraryDisturbsNoOther) {
  const testing::Scratch scratch;
  scratch.write("text.evodevo.so", "this is no library");
  const Registry registry({scratch / "", fs::path(EVODEVO_FAULTY_PLUGINS) / "sound"});
  ASSERT_EQ(registry.failed().size(), 1u);
  EXPECT_EQ(registry.failed()[0].file, scratch / "text.evodevo.so");
  EXPECT_THAT(registry.failed()[0].reason, ::testing::MatchesRegex("cannot be loaded: .*text.evodevo.so.*"));
  EXPECT_THAT(registry.failed()[0].reason, ::testing::EndsWith("; build it for this system, or remove it"));
  EXPECT_NE(registry.find("mutation", "nothing"), nullptr);
}

/// Tests the message for a folder without read permission. Root may read all folders, so as root the test switches to
/// another user.
TEST(Loader, AFolderWithoutPermissionIsNamed) {
  const testing::Scratch scratch;
  fs::create_directory(scratch / "closed");
  fs::permissions(scratch / "closed", fs::perms::none);
  const bool root = geteuid() == 0;
  ASSERT_TRUE(!root || seteuid(65534) == 0);
  const Registry registry({scratch / "closed"});
  ASSERT_TRUE(!root || seteuid(0) == 0);
  ASSERT_EQ(registry.failed().size(), 1u);
  EXPECT_EQ(registry.failed()[0].file, scratch / "closed");
  EXPECT_EQ(registry.failed()[0].reason,
            "cannot be read: Permission denied; make it readable, or leave it "
            "out of the plugin path");
}

TEST(Loader, AFolderThatIsNotThereIsNamed) {
  const Registry registry({"/no/such/folder"});
  ASSERT_EQ(registry.failed().size(), 1u);
  EXPECT_EQ(registry.failed()[0].file, "/no/such/folder");
  EXPECT_EQ(registry.failed()[0].reason,
            "cannot be read: No such file or directory; make it readable, or leave it out of the plugin path");
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
