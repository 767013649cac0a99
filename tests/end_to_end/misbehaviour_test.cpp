// Operators that misbehave: whether the run ends or continues, a message names the operator.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "archive/archive.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/program.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using namespace testing;
using ::testing::HasSubstr;

class Misbehaviour : public ::testing::Test {
 protected:
  Scratch scratch_;
  std::string file_ = scratch_.write("small.toml", small_experiment);
  std::string folder_ = (scratch_ / "run").string();
  std::string library_ = (fs::path(EVODEVO_FAULTY_PLUGINS) / "misbehaving/plugin.evodevo.so").string();

  /// Returns the command for a run in which the operator in the table `table` misbehaves in the way that `how` names.
  Words command(const std::string& table, const std::string& how, const std::string& more = "") const {
    return program({"run", file_, "--out", folder_, "--set",
                    table + "={name='misbehaves',how='" + how + "'" + more + "}", "--plugin-path", library_});
  }
  /// Returns such a command for a mutation operator that is applied to every child.
  Words mutating(const std::string& how) const { return command("mutation.0", how, ",probability=1.0"); }
  /// Runs a command in a new folder, expects the exit code, and returns the output.
  std::string output(const Words& command, int exit_code) const {
    fs::remove_all(folder_);
    return output_of(command, exit_code);
  }
  /// Returns the message with which an experiment with such an operator is refused.
  std::string refusal(const std::string& table, const std::string& how) const {
    try {
      read_experiment({file_, {{table, "{name='misbehaves',how='" + how + "'}", "--set"}}, {library_}});
    } catch (const std::exception& error) {
      return error.what();
    }
    return "nothing";
  }
  std::string named(const std::string& kind) const { return kind + " operator \"misbehaves\" of " + library_; }
  Archive archive() const { return Archive::read(folder_); }
};

TEST_F(Misbehaviour, ACallThatNeverEndsIsNamedAndOneCtrlCEndsItBeforeTheWarningToo) {
  for (const auto& [seconds, line] :
       {std::pair<const char*, std::string>{"0.05", "warning: " + named("mutation") + ", individual "},
        {"0.5", "it hangs"}}) {
    setenv("EVODEVO_PATIENCE", seconds, 1);
    fs::remove_all(folder_);
    Process process(mutating("hang"));
    std::optional<std::string> read;
    do {
      read = process.read_line();
    } while (read && read->find(line) == std::string::npos);
    EXPECT_TRUE(read.has_value()) << "no line has: " << line << "\n" << process.output();
    process.send(SIGINT);
    EXPECT_EQ(process.wait(), 130) << process.output();
    EXPECT_THAT(process.output(), naming("evodevo: interrupted: " + named("mutation") + ", individual ", ", seed 7: "));
    EXPECT_EQ(archive().generations().size(), 1u);
  }
  unsetenv("EVODEVO_PATIENCE");
}

TEST_F(Misbehaviour, AnOperatorThatExitsIsNoSuccess) {
  EXPECT_THAT(output(mutating("exit"), 1), naming(named("mutation") + ", individual 6, seed 7: ", "exit code 0"));
  EXPECT_EQ(archive().generations().size(), 1u);
  // several threads exit at the same time, which does not always go wrong
  const Words threads{"--threads", "4"};
  for (int i = 0; i < 8; ++i)
    EXPECT_THAT(output(joined(command("development.operator.0", "exit"), threads), 1),
                naming(named("devo") + ", individual ", "exit code 3"));
}

TEST_F(Misbehaviour, ACrashIsNamedWithWhatIsKnownOfTheCall) {
  EXPECT_THAT(output(mutating("overflow"), 128 + SIGSEGV),
              naming(named("mutation") + ", individual 6, seed 7: ", "stack overflow"));
  struct Case {
    std::string table, how, place;
  };
  const std::string developing = "devo operator \"misbehaves\" of .*, individual [0-5], cycle 2, seed 7: ";
  for (const auto& [table, how, place] :
       {Case{"development.operator.0", "overflow", developing + ".*stack overflow"},
        Case{"development.operator.0", "crash", developing + "crashed"},
        Case{"development.operator.0", "crash-when-asked", named("devo") + ", seed 7: crashed"},
        Case{"encoding", "crash-in-layout", named("encoding") + ", seed 7: crashed"},
        Case{"encoding", "crash", named("encoding") + ", individual [0-5], seed 7: crashed"},
        Case{"encoding", "crash-at-end", named("encoding") + ": crashed"},
        Case{"mutation.0", "crash-at-end", named("mutation") + ": crashed"},
        Case{"development.operator.0", "crash-at-end", named("devo") + ": crashed"},
        Case{"fitness.0", "crash-at-end", named("fitness") + ": crashed"}})
    EXPECT_THAT(output(command(table, how), 128 + SIGSEGV), ::testing::ContainsRegex(place)) << how;
}

TEST_F(Misbehaviour, WhatItChangesForAllIsPutBackAndNamed) {
  output(mutating("well"), 0);
  const double best = *archive().generations().back().best;
  for (const std::string how : {"round", "flush", "locale", "thread-locale", "global-locale"}) {
    SCOPED_TRACE(how);
    EXPECT_THAT(output(mutating(how), 0), HasSubstr("warning: " + named("mutation") + ": "));
    EXPECT_EQ(*archive().generations().back().best, best);
  }
}

TEST_F(Misbehaviour, WhatNoRunCanBeMadeWithIsRefused) {
  struct Case {
    std::string table, how, reason;
  };
  for (const auto& [table, how, reason] : std::vector<Case>{
           {"fitness.0", "no-window", "settle = 0 s and window = 0 s; expected"},
           {"fitness.0", "endless-window", "settle = 0 s and window = no finite number; expected"},
           {"fitness.0", "early-window", "settle = -0.1 s and window = 0.1 s; expected"},
           {"fitness.0", "window-that-is-no-number", "settle = no finite number and window = 0.1 s; expected"},
           {"fitness.0", "no-objective", "no scores"},
           {"fitness.0", "nameless-objective", "an objective without a name"},
           {"fitness.0", "descriptor-without-cells", "has bins = 0; expected 1 to 1000"},
           {"fitness.0", "descriptor-with-too-many-cells", "has bins = 1001; expected 1 to 1000"},
           {"fitness.0", "empty-descriptor", "has the range 1 to 1; expected"},
           {"fitness.0", "samples-without-end", "11000000 samples per second for 0.1 s; expected"},
           {"fitness.0", "samples-below-0", "-1 samples per second for 0.1 s; expected"},
           {"fitness.0", "channels-without-samples", "Request::rate"},
           {"fitness.0", "before-birth", "from cycle -1 of development on; expected 0 to 1"},
           {"fitness.0", "after-the-last-cycle", "from cycle 1000 of development on; expected 0 to 1"},
           {"fitness.0", "beyond-the-life", "until 10001 s of the life"},
           {"fitness.0", "unknown-role", "the role 99"},
           {"fitness.0", "twin-scores", "already a score \"one\""},
           {"selection", "nameless-note", "notes()"},
           {"selection", "twin-notes", "\"age\""},
           {"selection", "nameless-list", "memory()"},
           {"selection", "twin-lists", "\"age\""},
           {"encoding", "throw-in-layout", "std::exception"},
           {"development.operator.0", "throw-when-asked", "std::exception"}})
    EXPECT_THAT(refusal(table, how), naming(table + ".name = \"misbehaves\": ", reason)) << how;
  EXPECT_THAT(output(command("fitness.0", "no-window"), 2), HasSubstr("fitness.0.name = \"misbehaves\": "));
  EXPECT_FALSE(fs::exists(folder_));
}

TEST_F(Misbehaviour, WhatEndsARunIsNamed) {
  struct Case {
    std::string table, how, place, reason;
  };
  for (const auto& [table, how, place, reason] : std::vector<Case>{
           {"fitness.0", "one-score-too-many", named("fitness") + ", individual ", "2 scores, and objectives() has 1"},
           {"selection", "no-parents", named("selection"), "override parents()"},
           {"selection", "too-few-parents", named("selection"), "4 pairs of parents, expected 5"},
           {"selection", "no-survivors", named("selection"), "override survivors()"},
           {"encoding", "twin", named("encoding") + ", individual ", "joined already"}})
    EXPECT_THAT(output(command(table, how), 1), naming(place, reason)) << how;
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
