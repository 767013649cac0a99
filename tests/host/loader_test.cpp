// The border between host and plugins: the libraries that are refused, and the messages about them.
#include "operators/loader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cfenv>

#include "operators/declarations.hpp"
#include "support/messages.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using testing::naming;

namespace fs = std::filesystem;

/// Returns the message with which the only library in the folder `fault` of tests/plugins is refused.
std::string refusal(const std::string& fault, std::vector<fs::path> others_first = {}) {
  others_first.emplace_back(fs::path(EVODEVO_FAULTY_PLUGINS) / fault);
  const Registry registry(others_first);
  if (registry.failed().size() != 1) return std::to_string(registry.failed().size()) + " refusals";
  EXPECT_EQ(registry.failed()[0].file.parent_path().filename(), fault);
  return registry.failed()[0].reason;
}

constexpr const char* rebuild = "rebuild the plugin";

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
  EXPECT_THAT(refusal("magic"), naming("evodevo_plugin", "manifest", "EVODEVO_PLUGIN(...)"));
  EXPECT_THAT(refusal("epoch"), naming("ABI epoch", "99", std::to_string(plugin_epoch), rebuild));
  EXPECT_THAT(refusal("manifest_size"), naming("manifest", "8", std::to_string(sizeof(PluginManifest)), rebuild));
  EXPECT_THAT(refusal("structs"), naming("struct", "5", std::to_string(plugin_struct_digest), rebuild));
  EXPECT_THAT(refusal("toolchain"), naming("toolchain", "another compiler", plugin_toolchain, rebuild));
  EXPECT_THAT(refusal("switches"), naming("build switches", "-fpacked", "none", rebuild));
  EXPECT_THAT(refusal("no_entry"), naming("evodevo_plugin", "EVODEVO_PLUGIN(...)"));
  EXPECT_THAT(refusal("unknown_kind"), naming("operator \"nothing\"", "\"wing\"", rebuild));
  EXPECT_THAT(refusal("twin"), naming("mutation operator \"nothing\"", "twice", "rename"));
  EXPECT_THAT(refusal("default"), naming("mutation operator \"nothing\"", "genes = 7", "0 to 5", "correct"));
  EXPECT_THAT(refusal("constructor"),
              naming("mutation operator \"nothing\"", "\"no licence\"", "constructor", "parameters()"));
}

TEST(Loader, TextsThatDisturbATerminalAreRefused) {
  const auto of_text = [](const char* place, const char* value) {
    return naming(place, value, "300 bytes", "UTF-8", "control characters", "correct");
  };
  EXPECT_THAT(refusal("controls_in_name"), of_text("mutation operator", "\"noth\\x1b[31ming\""));
  EXPECT_THAT(refusal("controls_in_summary"), of_text("summary", "\"Changes\\nnothing.\""));
  EXPECT_THAT(refusal("controls_in_version"), of_text("version", "\"1.0\\x07\""));
  EXPECT_THAT(refusal("controls_in_licence"), of_text("licence", "\"MIT\\x07\""));
}

TEST(Loader, OnlyFilesAreLoaded) {
  const testing::Scratch scratch;
  fs::create_directory(scratch / "folder.evodevo.so");
  fs::create_symlink("/dev/zero", scratch / "zero.evodevo.so");
  ASSERT_EQ(mkfifo((scratch / "pipe.evodevo.so").c_str(), 0600), 0);
  const Registry registry({scratch / ""});
  EXPECT_EQ(registry.failed().size(), 3u);
  for (const FailedLibrary& failed : registry.failed()) EXPECT_THAT(failed.reason, naming("file", "remove"));
}

TEST(Loader, WhatAManifestLacksIsNamedAndDisturbsNoOther) {
  struct Fault {
    const char *library, *place, *what, *remedy;
  };
  const Fault faults[] = {
      {"null_kind", "operator 0", "kind", "EVODEVO_PLUGIN(...)"},
      {"null_name", "operator 0", "name", "EVODEVO_PLUGIN(...)"},
      {"empty_name", "operator 0", "name", "EVODEVO_PLUGIN(...)"},
      {"null_summary", "operator 0", "summary", "EVODEVO_PLUGIN(...)"},
      {"null_create", "operator 0", "creates", "operator_entry<Class>(...)"},
      {"creates_null", "mutation operator \"nothing\"", "class", "operator_entry<Class>(...)"},
      {"other_class", "devo operator \"nothing\"", "class", "operator_entry<Class>(...)"},
      {"null_toolchain", "toolchain", plugin_toolchain, rebuild},
      {"null_version", "version", "missing", "EVODEVO_PLUGIN(...)"},
      {"empty_licence", "licence", "missing", "EVODEVO_PLUGIN(...)"},
      {"null_entries", "list of operators", "no", "EVODEVO_PLUGIN(...)"},
      {"constructor_throws_a_number", "mutation operator \"nothing\"", "std::exception", "must not throw"},
      {"static_throws", "while it is loaded", "crashes", "remove"}};
  std::vector<fs::path> all;
  for (const auto& [fault, place, what, to_do] : faults) {
    EXPECT_THAT(refusal(fault), naming(place, what, "; ", to_do)) << fault;
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
  EXPECT_THAT(refusal("reserved"), naming("mutation operator \"nothing\"", "parameter \"every\"", "rename"));
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
  EXPECT_THAT(said, naming("warning: ", "rounds/plugin.evodevo.so: ", "the rounding mode"));
}

TEST(Loader, ALibraryThatLacksASymbolIsRefusedWithItsName) {
  EXPECT_THAT(refusal("undefined_symbol"), ::testing::MatchesRegex("cannot be loaded: .*undefined symbol.*nobody.*"));
  EXPECT_THAT(refusal("undefined_symbol"), naming("link", "-Wl,-z,defs"));
}

TEST(Loader, TheEntryOfALinkedLibraryIsNotItsOwn) {
  EXPECT_THAT(refusal("borrowed_entry"),
              naming("evodevo_plugin of its own",
                     (fs::path(EVODEVO_FAULTY_PLUGINS) / "sound/plugin.evodevo.so").string(), "EVODEVO_PLUGIN(...)"));
}

TEST(Loader, ALibraryThatCrashesIsRefusedAndDisturbsNoOther) {
  const fs::path sound = fs::path(EVODEVO_FAULTY_PLUGINS) / "sound";
  EXPECT_THAT(refusal("crash", {sound}), naming("crashes", "Segmentation fault", "static objects", "remove"));
  EXPECT_THAT(refusal("exit", {sound}), naming("crashes", "exit code 3", "static objects", "remove"));
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
    return naming("mutation operator \"reset-weight\"", first.string(), "rename", "plugin path");
  };
  EXPECT_THAT(refusal("taken_name", {builtin_plugin_folder()}), twin(built_in));
  const Registry registry({own, builtin_plugin_folder()});
  ASSERT_EQ(registry.failed().size(), 1u);
  EXPECT_EQ(registry.failed()[0].file, built_in);
  EXPECT_THAT(registry.failed()[0].reason, twin(own / "plugin.evodevo.so"));
  EXPECT_EQ(registry.find("mutation", "reset-weight")->file, own / "plugin.evodevo.so");
}

TEST(Loader, AFileThatIsNoLibraryDisturbsNoOther) {
  const testing::Scratch scratch;
  scratch.write("text.evodevo.so", "this is no library");
  const Registry registry({scratch / "", fs::path(EVODEVO_FAULTY_PLUGINS) / "sound"});
  ASSERT_EQ(registry.failed().size(), 1u);
  EXPECT_EQ(registry.failed()[0].file, scratch / "text.evodevo.so");
  EXPECT_THAT(registry.failed()[0].reason, ::testing::MatchesRegex("cannot be loaded: .*text.evodevo.so.*"));
  EXPECT_THAT(registry.failed()[0].reason, naming("; ", "build", "remove"));
  EXPECT_NE(registry.find("mutation", "nothing"), nullptr);
}

/// Tests the message for a folder without read permission. Root may read all folders, so as root the test switches to
/// another user.
TEST(Loader, AFolderWithoutPermissionIsNamed) {
  const testing::Scratch scratch;
  fs::create_directory(scratch / "closed");
  fs::permissions(scratch / "closed", fs::perms::none);
  fs::permissions(scratch / ".", fs::perms(0755));  // so that the other user gets that far
  const bool root = geteuid() == 0;
  if (root && seteuid(65534) != 0) GTEST_SKIP() << "root cannot switch to another user";
  const Registry registry({scratch / "closed"});
  ASSERT_TRUE(!root || seteuid(0) == 0);
  ASSERT_EQ(registry.failed().size(), 1u);
  EXPECT_EQ(registry.failed()[0].file, scratch / "closed");
  EXPECT_THAT(registry.failed()[0].reason, naming("Permission denied", "readable", "plugin path"));
}

TEST(Loader, AFolderThatIsNotThereIsNamed) {
  const Registry registry({"/no/such/folder"});
  ASSERT_EQ(registry.failed().size(), 1u);
  EXPECT_EQ(registry.failed()[0].file, "/no/such/folder");
  EXPECT_THAT(registry.failed()[0].reason, naming("No such file or directory", "plugin path"));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
