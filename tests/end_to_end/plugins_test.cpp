// Plugins from the point of view of users: the folders in which plugins are found, the data about plugins in the record
// of a run, and the effect of faulty plugins on a run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <sstream>

#include "base/text.hpp"
#include "evolution/archive/archive.hpp"
#include "operators/loader.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/process.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using testing::Finished;
using ::testing::HasSubstr;

const fs::path plugins = EVODEVO_FAULTY_PLUGINS;

class Plugins : public ::testing::Test {
 protected:
  testing::Scratch scratch_;
  std::string file_ = scratch_.write("small.toml", testing::small_experiment);
  std::string folder_ = (scratch_ / "run").string();
  fs::path library_ = scratch_ / "own" / "plugin.evodevo.so";

  void SetUp() override {
    fs::create_directory(scratch_ / "own");
    become_user("one");
  }
  void TearDown() override { unsetenv("XDG_STATE_HOME"); }

  /// Switches to another user's state folder, in which evodevo remembers that user's folders of operators.
  void become_user(const std::string& name) const { setenv("XDG_STATE_HOME", (scratch_ / name).c_str(), 1); }

  /// Copies a library from tests/plugins to the folder in which the user keeps plugins.
  void install(const std::string& which) {
    fs::copy_file(plugins / which / "plugin.evodevo.so", library_, fs::copy_options::overwrite_existing);
  }
  std::string own() const { return (scratch_ / "own").string(); }
  /// The path of the same folder in the form in which a record stores it.
  std::string recorded_own() const { return fs::path(own()).lexically_normal().string(); }

  static Finished evodevo(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), EVODEVO_PROGRAM);
    return testing::run(arguments);
  }
  Finished run_with(const std::string& mutation, std::vector<std::string> more) const {
    more.insert(more.begin(),
                {"run", file_, "--set", "mutation.0.name=" + mutation, "--set", "mutation.0.probability=1"});
    if (std::find(more.begin(), more.end(), "--out") == more.end()) more.insert(more.end(), {"--out", folder_});
    return evodevo(more);
  }
};

TEST_F(Plugins, AreFoundByOptionVariableAndExperiment) {
  install("sound");
  EXPECT_EQ(evodevo({"check", file_, "--set", "mutation.0.name=nothing"}).exit_code, 2);
  EXPECT_EQ(evodevo({"check", file_, "--set", "mutation.0.name=nothing", "--plugin-path", own()}).exit_code, 0);
  EXPECT_EQ(evodevo({"check", file_, "--set", "mutation.0.name=nothing", "--set", "plugins.paths=['own']"}).exit_code,
            0);
  EXPECT_THAT(evodevo({"operators", "--plugin-path", own()}).output, HasSubstr("nothing"));
  EXPECT_THAT(evodevo({"describe", "nothing", "--plugin-path", own()}).output, HasSubstr("from " + library_.string()));
  setenv("EVODEVO_PLUGIN_PATH", own().c_str(), 1);
  EXPECT_EQ(evodevo({"check", file_, "--set", "mutation.0.name=nothing"}).exit_code, 0);
  unsetenv("EVODEVO_PLUGIN_PATH");
  EXPECT_THAT(evodevo({"check", file_, "--plugin-path", "/no/such"}).output,
              AllOf(HasSubstr("--plugin-path /no/such: "), HasSubstr("build the plugin")));
}

TEST_F(Plugins, TheExperimentsPathsComeBeforeTheOptionsAndThoseBeforeTheVariables) {
  const std::string older = (plugins / "sound").string(), newer = (plugins / "newer").string();
  const auto version = [&](const std::string& experiment, const std::string& option) {
    const Override name{"mutation.0.name", "nothing", ""}, paths{"plugins.paths", "[" + experiment + "]", ""};
    const Experiment read = read_experiment({file_, {name, paths}, {option}});
    const auto is_it = [](const OperatorUse& use) { return use.name == "nothing"; };
    return std::find_if(read.uses.begin(), read.uses.end(), is_it)->version;
  };
  EXPECT_EQ(version("'" + older + "'", newer), "1.0.0");
  EXPECT_EQ(version("'" + newer + "'", older), "2.0.0");
  setenv("EVODEVO_PLUGIN_PATH", newer.c_str(), 1);
  EXPECT_EQ(version("", older), "1.0.0");
  unsetenv("EVODEVO_PLUGIN_PATH");
}

TEST_F(Plugins, TheRecordKeepsFileVersionAndHash) {
  install("sound");
  ASSERT_EQ(run_with("nothing", {"--plugin-path", own()}).exit_code, 0);
  const Provenance provenance = Archive::read(folder_).provenances().front();
  EXPECT_EQ(provenance.program, file_hash(EVODEVO_PROGRAM));
  for (const OperatorUse& use : provenance.operators) {
    EXPECT_EQ(use.hash, file_hash(use.file)) << use.name;
    if (use.name != "nothing") continue;
    EXPECT_EQ(use.file, library_);
    EXPECT_EQ(use.version, "1.0.0");
  }
  EXPECT_EQ(evodevo({"resume", folder_}).exit_code, 0) << "the record knows the folder";
}

TEST_F(Plugins, TheSameCommandGoesOnWithThem) {
  install("sound");
  const std::vector<std::string> command{"--plugin-path", own(), "--set",    "experiment.evaluations=1000000",
                                         "--until",       "1s",  "--resume", "--no-report"};
  for (int i = 0; i < 2; ++i) {
    const Finished finished = run_with("nothing", command);
    EXPECT_EQ(finished.exit_code, 130) << finished.output;
  }
}

TEST_F(Plugins, ResumeRefusesAnotherVersionUnlessTold) {
  install("sound");
  const std::vector<std::string> endless{"--plugin-path", own(), "--set", "experiment.evaluations=1000000",
                                         "--until",       "1s"};
  ASSERT_EQ(run_with("nothing", endless).exit_code, 130) << "a run that is complete is not continued";
  install("newer");
  const std::string now = library_.lexically_normal().string();
  const Finished refused = evodevo({"resume", folder_});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output,
              AllOf(HasSubstr(folder_ + ": "), HasSubstr("mutation operator \"nothing\" 1.0.0"), HasSubstr(now),
                    HasSubstr("2.0.0"), HasSubstr(library_.string()), HasSubstr("--allow-other-versions")));
  const Finished allowed = evodevo({"resume", folder_, "--allow-other-versions", "--until", "1s"});
  EXPECT_EQ(allowed.exit_code, 130) << allowed.output;
  EXPECT_THAT(allowed.output,
              testing::naming("warning: ", "mutation operator \"nothing\" 1.0.0", "version 2.0.0", now));
}

TEST_F(Plugins, AnUnusableLibraryStopsNoRunThatDoesNotUseIt) {
  install("crash");
  const Finished finished =
      evodevo({"run", file_, "--out", folder_, "--plugin-path", own(), "--set", "experiment.evaluations=6"});
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output, testing::naming("warning: ", library_.string() + ": ", "crashes"));
  const Finished failed = evodevo({"operators", "--failed", "--plugin-path", own()});
  EXPECT_EQ(failed.exit_code, 0);
  EXPECT_THAT(failed.output,
              testing::at_place(library_.string() + ": ", "crashes", "Segmentation fault", "static objects", "remove"));
  EXPECT_EQ(evodevo({"operators", "--failed"}).output, "");
}

TEST_F(Plugins, OfTwoLibrariesWithOneNameTheFirstIsUsedAndTheOtherNamed) {
  install("taken_name");
  const Finished finished = run_with("reset-weight", {"--plugin-path", own()});
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_THAT(finished.output,
              testing::naming("warning: ", (builtin_plugin_folder() / "reset-weight.evodevo.so").string() + ": ",
                              "mutation operator \"reset-weight\"", library_.string(), "rename", "plugin path"));
  const auto uses = Archive::read(folder_).provenances().front().operators;
  const auto mutation = std::find_if(uses.begin(), uses.end(), [](const auto& use) { return use.kind == "mutation"; });
  ASSERT_NE(mutation, uses.end());
  EXPECT_EQ(mutation->file, library_);
}

TEST_F(Plugins, TextsOfOperatorsReachNoTerminalAsTheyAre) {
  const auto expect_clean = [](const std::string& output) {
    std::istringstream lines(output);
    for (std::string line; std::getline(lines, line);) EXPECT_EQ(line, printable(line, 5000));
  };
  install("controls_thrown");
  const Finished thrown = run_with("nothing", {"--plugin-path", own()});
  EXPECT_EQ(thrown.exit_code, 1);
  EXPECT_THAT(thrown.output, HasSubstr(": \\x1b[31mnothing\\nto mutate\\xff!!!!"));
  EXPECT_THAT(thrown.output, HasSubstr("...; correct the operator"));
  expect_clean(thrown.output);
  install("controls_in_parameter");
  const Finished described = evodevo({"describe", "nothing", "--plugin-path", own()});
  EXPECT_THAT(described.output, HasSubstr("  genes\\x1b[31m = 1\n"));
  EXPECT_THAT(described.output, HasSubstr("      Genes\\nthat change.\\xff\n"));
  expect_clean(described.output);
  for (const char* form : {"--json", "--markdown"}) {
    const Finished listed = evodevo({"operators", form, "--plugin-path", own()});
    EXPECT_EQ(listed.exit_code, 0) << listed.output;
    expect_clean(listed.output);
  }
  install("controls_in_objective");
  std::string text = testing::small_experiment;  // whose second fitness has parameters that "way" does not have
  const std::size_t second = text.rfind("[[fitness]]");
  text.replace(second, text.find("\n[", second) - second, "[[fitness]]\nname = \"way\"\n");
  const Finished refused = evodevo({"check", scratch_.write("way.toml", text), "--plugin-path", own()});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, testing::naming("fitness.1.name = \"way\": ", "\"way\\x1b[31m\"", "control characters"));
  expect_clean(refused.output);
}

TEST_F(Plugins, AnOperatorThatErrsIsNamedWithItsFile) {
  const std::string place = "mutation operator \"nothing\" of " + library_.string() + ", individual 6, seed 7: ";
  install("throws");
  const Finished thrown = run_with("nothing", {"--plugin-path", own()});
  EXPECT_EQ(thrown.exit_code, 1);
  EXPECT_THAT(thrown.output, testing::naming(place + "nothing to mutate", "correct the operator", "new run"));
  install("nan");
  const Finished poisoned = run_with("nothing", {"--plugin-path", own(), "--out", folder_ + "2"});
  EXPECT_EQ(poisoned.exit_code, 1);
  EXPECT_THAT(poisoned.output, testing::naming(place, "gene 0 = not a number", "correct the operator", "new run"));
}

TEST_F(Plugins, AnOperatorThatCrashesIsNamedWithItsFile) {
  install("crash_in_use");
  const Finished crashed = run_with("nothing", {"--plugin-path", own()});
  EXPECT_NE(crashed.exit_code, 0);
  EXPECT_THAT(crashed.output, testing::naming("evodevo: mutation operator \"nothing\" of " + library_.string() +
                                                  ", individual 6, seed 7: crashed: Segmentation fault",
                                              "`evodevo conform " + library_.string() + " --experiment "));
}

TEST_F(Plugins, AnOperatorThatReadsBeyondTheGenesIsNamedWithItsFile) {
  install("reads_beyond");
  const Finished stopped = run_with("nothing", {"--plugin-path", own()});
  EXPECT_NE(stopped.exit_code, 0);
  EXPECT_THAT(stopped.output,
              testing::naming(library_.string() + ", individual 6, seed 7: crashed: Aborted", "conform"));
}

TEST_F(Plugins, ARunOutlivesTheFolderOfItsOperators) {
  install("sound");
  ASSERT_EQ(run_with("nothing", {"--plugin-path", own()}).exit_code, 0);
  const std::string moved = (scratch_ / "moved").string();
  std::filesystem::rename(own(), moved);
  const Finished missed = evodevo({"life", folder_});
  EXPECT_EQ(missed.exit_code, 2);
  EXPECT_THAT(missed.output, testing::naming("mutation.0.name = \"nothing\"", recorded_own(), "--plugin-path"));
  const Finished found = evodevo({"life", folder_, "--plugin-path", moved});
  EXPECT_EQ(found.exit_code, 0) << found.output;
}

/// Returns all commands that load the plugins named in a record.
std::vector<std::vector<std::string>> readers_of(const std::string& folder, const std::string& file) {
  return {{"resume", folder},
          {"life", folder},
          {"body", folder},
          {"verify", folder},
          {"report", folder, "--best", "0", "--out", folder + ".html"},
          {"film", folder, "--out", folder + ".png"},
          {"environments", file, "--run", folder, "--starts", "1"}};
}

TEST_F(Plugins, FoldersThatTheUserHasRunWithAreRemembered) {
  install("sound");
  for (const char* run : {"1", "2"})
    ASSERT_EQ(run_with("nothing", {"--set", "plugins.paths=['own']", "--out", folder_ + run}).exit_code, 0);
  std::ifstream memory(scratch_ / "one" / "evodevo" / "plugin-folders");
  const std::string lines{std::istreambuf_iterator<char>(memory), {}};
  EXPECT_EQ(lines, fs::canonical(own()).string() + "\n") << "once";
  EXPECT_EQ(evodevo({"resume", folder_ + "1"}).exit_code, 0);
  EXPECT_EQ(evodevo({"life", folder_ + "2"}).exit_code, 0);
}

TEST_F(Plugins, ARecordOfAnotherLoadsNothingThatTheUserHasNotNamed) {
  install("sound");
  ASSERT_EQ(run_with("nothing", {"--set", "plugins.paths=['own']"}).exit_code, 0);
  become_user("another");
  for (const std::vector<std::string>& command : readers_of(folder_, file_)) {
    const Finished refused = evodevo(command);
    if (refused.output.find("evodevo_viewer") != std::string::npos) continue;  // the viewer is not built
    EXPECT_EQ(refused.exit_code, 2) << command.front();
    EXPECT_THAT(refused.output, HasSubstr("mutation.0.name = \"nothing\"")) << command.front();
    EXPECT_THAT(refused.output, HasSubstr("--plugin-path " + recorded_own())) << command.front();
  }
  EXPECT_EQ(evodevo({"show", folder_, "--json"}).exit_code, 0) << "numbers are printed without operators";
  EXPECT_EQ(evodevo({"life", folder_, "--plugin-path", own()}).exit_code, 0);
  setenv("EVODEVO_PLUGIN_PATH", own().c_str(), 1);
  EXPECT_EQ(evodevo({"life", folder_}).exit_code, 0);
  unsetenv("EVODEVO_PLUGIN_PATH");
  EXPECT_EQ(evodevo({"life", folder_}).exit_code, 2) << "looking at a run is not running it";
}

TEST_F(Plugins, ALibraryBesideARecordIsNotLoaded) {
  install("sound");
  ASSERT_EQ(run_with("nothing", {"--plugin-path", own()}).exit_code, 0);
  fs::copy(own(), folder_ + "/own");
  {
    Archive archive = Archive::annotate(folder_);
    std::string experiment = archive.record("experiment");
    const std::string recorded = "'" + recorded_own() + "'";
    ASSERT_NE(experiment.find(recorded), std::string::npos) << experiment;
    archive.set_record("experiment", experiment.replace(experiment.find(recorded), recorded.size(), "'own'"));
  }
  for (const std::string& here : {own(), folder_}) {
    const Finished there =
        testing::run({"sh", "-c", "cd '" + here + "' && exec " EVODEVO_PROGRAM " life '" + folder_ + "'"});
    EXPECT_EQ(there.exit_code, 2);
    EXPECT_THAT(there.output, testing::naming("mutation.0.name = \"nothing\"", "own ", "relative", "--plugin-path"));
  }
}

TEST_F(Plugins, WithoutAHomeNothingIsRememberedOrWritten) {
  install("sound");
  const fs::path here = scratch_ / "here";
  fs::create_directory(here);
  for (const char* homes : {"-u HOME -u XDG_STATE_HOME", "HOME= XDG_STATE_HOME=", "HOME=here XDG_STATE_HOME=here"}) {
    const Finished finished =
        testing::run({"sh", "-c",
                      "cd '" + here.string() + "' && exec env " + homes + " " EVODEVO_PROGRAM " run '" + file_ +
                          "' --set mutation.0.name=nothing --plugin-path '" + own() + "' --out '" + folder_ + "'"});
    EXPECT_EQ(finished.exit_code, 0) << finished.output;
    EXPECT_THAT(finished.output, testing::naming("warning: ", "HOME", "XDG_STATE_HOME", "--plugin-path"));
    EXPECT_TRUE(fs::is_empty(here)) << homes;
    fs::remove_all(folder_);
  }
}

TEST_F(Plugins, AnOperatorOfAnUnusableLibraryIsMissedWithTheReason) {
  install("epoch");
  const Finished finished = run_with("nothing", {"--plugin-path", own()});
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_THAT(finished.output, testing::naming("mutation.0.name = \"nothing\"", library_.string() + ": ", "ABI epoch",
                                               "99", std::to_string(plugin_epoch)));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
