// Plugins from the point of view of users: the folders in which plugins are found, the data about plugins in the record
// of a run, and the effect of faulty plugins on a run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <sstream>

#include "archive/archive.hpp"
#include "base/text.hpp"
#include "operators/loader.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/program.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using namespace testing;
using ::testing::HasSubstr;

const fs::path plugins = EVODEVO_FAULTY_PLUGINS;

class Plugins : public ::testing::Test {
 protected:
  Scratch scratch_;
  std::string file_ = scratch_.write("small.toml", small_experiment);
  std::string folder_ = (scratch_ / "run").string();
  std::string own_ = (scratch_ / "own").string();  ///< the folder in which the user keeps plugins
  fs::path library_ = scratch_ / "own" / "plugin.evodevo.so";
  std::string recorded_own_ = fs::path(own_).lexically_normal().string();  ///< as a record stores it

  void SetUp() override {
    fs::create_directory(own_);
    become_user("one");
  }
  void TearDown() override { unsetenv("XDG_STATE_HOME"); }

  /// Switches to another user's state folder, in which evodevo remembers that user's folders of operators.
  void become_user(const std::string& name) const { setenv("XDG_STATE_HOME", (scratch_ / name).c_str(), 1); }

  /// Copies a library from tests/plugins to the folder in which the user keeps plugins.
  void install(const std::string& which) {
    fs::copy_file(plugins / which / "plugin.evodevo.so", library_, fs::copy_options::overwrite_existing);
  }
  /// Returns a command on the experiment with the mutation operator of these libraries.
  Words using_nothing(const std::string& command, const Words& more) const {
    const Words values{"mutation.0.name=nothing", "mutation.0.probability=1"};
    return joined(joined({command, file_}, setting(values)), more);
  }
  Words run_words(const Words& more = {}) const {
    return using_nothing("run", joined({"--out", folder_, "--plugin-path", own_}, more));
  }
};

TEST_F(Plugins, AreFoundByTheExperimentsPathsThenTheOptionsThenTheVariable) {
  install("sound");
  refusal(using_nothing("check", {}));
  said(using_nothing("check", {"--set", "plugins.paths=['own']"}));
  EXPECT_THAT(said({"describe", "nothing", "--plugin-path", own_}), HasSubstr("from " + library_.string()));
  EXPECT_THAT(evodevo({"check", file_, "--plugin-path", "/no/such"}).output,
              naming("--plugin-path /no/such: ", "build the plugin"));
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

TEST_F(Plugins, ARecordKeepsFileVersionAndHashOutlivesTheFolderAndLoadsNoLibraryBesideIt) {
  install("sound");
  said(run_words());
  const Provenance provenance = Archive::read(folder_).provenances().front();
  EXPECT_EQ(provenance.program, file_hash(EVODEVO_PROGRAM));
  for (const OperatorUse& use : provenance.operators) {
    EXPECT_EQ(use.hash, file_hash(use.file)) << use.name;
    if (use.name != "nothing") continue;
    EXPECT_EQ(use.file, library_);
    EXPECT_EQ(use.version, "1.0.0");
  }
  said({"resume", folder_});  // the record knows the folder

  const std::string moved = (scratch_ / "moved").string();
  fs::rename(own_, moved);
  EXPECT_THAT(refusal({"life", folder_}), naming("mutation.0.name = \"nothing\"", recorded_own_, "--plugin-path"));
  said({"life", folder_, "--plugin-path", moved});
  fs::rename(moved, own_);

  fs::copy(own_, folder_ + "/own");
  {
    Archive archive = Archive::annotate(folder_);
    std::string experiment = archive.record("experiment");
    const std::string recorded = "'" + recorded_own_ + "'";
    ASSERT_NE(experiment.find(recorded), std::string::npos) << experiment;
    archive.set_record("experiment", experiment.replace(experiment.find(recorded), recorded.size(), "'own'"));
  }
  for (const std::string& here : {own_, folder_})
    EXPECT_THAT(output_of({"sh", "-c", "cd '" + here + "' && exec " EVODEVO_PROGRAM " life '" + folder_ + "'"}, 2),
                naming("mutation.0.name = \"nothing\"", "own ", "relative", "--plugin-path"));
}

TEST_F(Plugins, TheSameCommandGoesOnWithThemButNotWithAnotherVersionUnlessTold) {
  install("sound");
  const Words endless = run_words({"--set", "experiment.evaluations=1000000", "--until", "1s", "--resume"});
  for (int i = 0; i < 2; ++i) output_of(program(endless), 130);
  install("newer");
  const std::string now = library_.lexically_normal().string();
  EXPECT_THAT(refusal({"resume", folder_}), naming(folder_ + ": ", "mutation operator \"nothing\" 1.0.0", now, "2.0.0",
                                                   library_.string(), "--allow-other-versions"));
  const Words allowed = program({"resume", folder_, "--allow-other-versions", "--until", "1s"});
  EXPECT_THAT(output_of(allowed, 130),
              naming("warning: ", "mutation operator \"nothing\" 1.0.0", "version 2.0.0", now));
}

TEST_F(Plugins, AnUnusableLibraryStopsNoRunThatDoesNotUseIt) {
  install("crash");
  EXPECT_THAT(said({"run", file_, "--out", folder_, "--plugin-path", own_, "--set", "experiment.evaluations=6"}),
              naming("warning: ", library_.string() + ": ", "crashes"));
  EXPECT_THAT(said({"operators", "--failed", "--plugin-path", own_}),
              at_place(library_.string() + ": ", "crashes", "Segmentation fault"));
  EXPECT_EQ(evodevo({"operators", "--failed"}).output, "");
  EXPECT_THAT(refusal(using_nothing("check", {"--plugin-path", own_})),
              naming("mutation.0.name = \"nothing\"", library_.string() + ": ", "crashes"));
}

TEST_F(Plugins, TextsOfOperatorsReachNoTerminalAsTheyAre) {
  const auto clean = [](const std::string& output) {
    std::istringstream lines(output);
    for (std::string line; std::getline(lines, line);) EXPECT_EQ(line, printable(line, 5000));
    return output;
  };
  install("controls_thrown");
  EXPECT_THAT(clean(output_of(program(run_words()), 1)),
              naming(": \\x1b[31mnothing\\nto mutate\\xff!!!!", "...; correct the operator"));
  install("controls_in_parameter");
  EXPECT_THAT(clean(evodevo({"describe", "nothing", "--plugin-path", own_}).output),
              naming("  genes\\x1b[31m = 1\n", "      Genes\\nthat change.\\xff\n"));
  for (const char* form : {"--json", "--markdown"}) clean(said({"operators", form, "--plugin-path", own_}));
  install("controls_in_objective");
  std::string text = small_experiment;  // whose second fitness has parameters that "way" does not have
  const std::size_t second = text.rfind("[[fitness]]");
  text.replace(second, text.find("\n[", second) - second, "[[fitness]]\nname = \"way\"\n");
  EXPECT_THAT(clean(refusal({"check", scratch_.write("way.toml", text), "--plugin-path", own_})),
              naming("fitness.1.name = \"way\": ", "\"way\\x1b[31m\"", "control characters"));
}

TEST_F(Plugins, AnOperatorThatErrsOrCrashesIsNamedWithItsFile) {
  const std::string place = "mutation operator \"nothing\" of " + library_.string() + ", individual 6, seed 7: ";
  struct Fault {
    std::string library, reason, remedy;
  };
  for (const auto& [library, reason, remedy] :
       {Fault{"throws", "nothing to mutate", "new run"}, Fault{"nan", "gene 0 = not a number", "new run"},
        Fault{"crash_in_use", "crashed: Segmentation fault",
              "`evodevo conform " + library_.string() + " --experiment "},
        Fault{"reads_beyond", "crashed: Aborted", "conform"}}) {
    SCOPED_TRACE(library);
    fs::remove_all(folder_);
    install(library);
    const Finished finished = evodevo(run_words());
    EXPECT_TRUE(remedy == "new run" ? finished.exit_code == 1 : finished.exit_code != 0);
    EXPECT_THAT(finished.output, naming(place, reason, remedy));
  }
}

TEST_F(Plugins, FoldersThatTheUserHasRunWithAreRememberedAndNothingIsLoadedFromAnothers) {
  install("sound");
  const Words by_path{"--set", "plugins.paths=['own']", "--out"};
  for (const char* run : {"1", "2"}) said(using_nothing("run", joined(by_path, {folder_ + run})));
  std::ifstream memory(scratch_ / "one" / "evodevo" / "plugin-folders");
  const std::string lines{std::istreambuf_iterator<char>(memory), {}};
  EXPECT_EQ(lines, fs::canonical(own_).string() + "\n") << "once";
  said({"resume", folder_ + "1"});
  said({"life", folder_ + "2"});

  become_user("another");
  const std::string run = folder_ + "1";
  const std::vector<Words> readers = {{"resume", run},
                                      {"life", run},
                                      {"body", run},
                                      {"verify", run},
                                      {"report", run, "--best", "0", "--out", run + ".html"},
                                      {"film", run, "--out", run + ".png"},
                                      {"environments", file_, "--run", run, "--starts", "1"}};
  for (const Words& command : readers) {
    const Finished refused = evodevo(command);
    if (refused.output.find("evodevo_viewer") != std::string::npos) continue;  // the viewer is not built
    EXPECT_EQ(refused.exit_code, 2) << command.front();
    EXPECT_THAT(refused.output, naming("mutation.0.name = \"nothing\"", "--plugin-path " + recorded_own_));
  }
  said({"show", run, "--json"});  // numbers are printed without operators
  said({"life", run, "--plugin-path", own_});
  setenv("EVODEVO_PLUGIN_PATH", own_.c_str(), 1);
  said({"life", run});
  unsetenv("EVODEVO_PLUGIN_PATH");
  refusal({"life", run});  // looking at a run is not running it
}

TEST_F(Plugins, WithoutAHomeNothingIsRememberedOrWritten) {
  install("sound");
  const fs::path here = scratch_ / "here";
  fs::create_directory(here);
  for (const std::string homes :
       {"-u HOME -u XDG_STATE_HOME -u XDG_CACHE_HOME",
        "HOME= XDG_STATE_HOME= XDG_CACHE_HOME=", "HOME=here XDG_STATE_HOME=here XDG_CACHE_HOME=here"}) {
    fs::remove_all(folder_);
    const Words inside{"sh", "-c", "cd '" + here.string() + "' && exec env " + homes + " \"$@\"", "sh"};
    EXPECT_THAT(output_of(joined(inside, program(run_words()))),
                naming("warning: ", "HOME", "XDG_STATE_HOME", "--plugin-path"));
    EXPECT_TRUE(fs::is_empty(here)) << homes;
  }
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
