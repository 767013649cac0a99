// Operators that misbehave: whether the run ends or continues, a message names the operator.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evolution/archive/archive.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/process.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using testing::Finished;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Process;

class Misbehaviour : public ::testing::Test {
 protected:
  testing::Scratch scratch_;
  std::string file_ = scratch_.write("small.toml", testing::small_experiment);
  std::string folder_ = (scratch_ / "run").string();
  std::string library_ = (fs::path(EVODEVO_FAULTY_PLUGINS) / "misbehaving/plugin.evodevo.so").string();

  /// Returns the command for a run in which the operator in the table `table` misbehaves in the way that `how` names.
  std::vector<std::string> run_with(const std::string& table, const std::string& how,
                                    const std::string& more = "") const {
    return {EVODEVO_PROGRAM,
            "run",
            file_,
            "--out",
            folder_,
            "--set",
            table + "={name='misbehaves',how='" + how + "'" + more + "}",
            "--plugin-path",
            library_};
  }
  /// Returns such a command for a mutation operator that is applied to every child.
  std::vector<std::string> mutating(const std::string& how) const {
    return run_with("mutation.0", how, ",probability=1.0");
  }
  std::string named(const std::string& kind) const { return kind + " operator \"misbehaves\" of " + library_; }
  std::size_t generations_kept() const { return Archive::read(folder_).generations().size(); }
};

/// Reads lines until one contains the text.
void read_to(Process& process, const std::string& text) {
  while (const auto line = process.read_line())
    if (line->find(text) != std::string::npos) return;
  ADD_FAILURE() << "no line has: " << text << "\n" << process.output();
}

/// Sets EVODEVO_PATIENCE for the processes that are started during the lifetime of this object.
struct Patience {
  explicit Patience(const char* seconds) { setenv("EVODEVO_PATIENCE", seconds, 1); }
  ~Patience() { unsetenv("EVODEVO_PATIENCE"); }
};

TEST_F(Misbehaviour, ACallThatNeverEndsIsNamedAndOneCtrlCEndsIt) {
  const Patience patience("0.05");
  Process process(mutating("hang"));
  read_to(process, "warning: " + named("mutation") + ", individual ");
  process.send(SIGINT);
  EXPECT_EQ(process.wait(), 130) << process.output();
  EXPECT_THAT(process.output(), HasSubstr("evodevo: interrupted: " + named("mutation") + ", individual "));
  EXPECT_THAT(process.output(), HasSubstr(", seed 7: "));
  EXPECT_EQ(generations_kept(), 1u);
}

TEST_F(Misbehaviour, CtrlCBeforeTheWarningSufficesToo) {
  const Patience patience("0.5");
  Process process(mutating("hang"));
  read_to(process, "it hangs");
  process.send(SIGINT);
  EXPECT_EQ(process.wait(), 130) << process.output();
  EXPECT_THAT(process.output(), HasSubstr("evodevo: interrupted: " + named("mutation") + ", individual "));
  EXPECT_EQ(generations_kept(), 1u);
}

TEST_F(Misbehaviour, AnOperatorThatExitsIsNoSuccess) {
  for (const char* how : {"exit", "exit-at-once", "quick-exit"}) {
    fs::remove_all(folder_);
    const Finished finished = testing::run(mutating(how));
    EXPECT_EQ(finished.exit_code, 1) << how << finished.output;
    EXPECT_THAT(finished.output, testing::naming(named("mutation") + ", individual 6, seed 7: ", "exit code 0")) << how;
    EXPECT_EQ(generations_kept(), 1u);
  }
}

TEST_F(Misbehaviour, AStackThatOverflowsIsNamed) {
  const Finished on_main_thread = testing::run(mutating("overflow"));
  EXPECT_EQ(on_main_thread.exit_code, 128 + SIGSEGV);
  EXPECT_THAT(on_main_thread.output, testing::naming(named("mutation") + ", individual 6, seed 7: ", "stack overflow"));
  fs::remove_all(folder_);
  const Finished on_another = testing::run(run_with("development.operator.0", "overflow"));
  EXPECT_EQ(on_another.exit_code, 128 + SIGSEGV);
  EXPECT_THAT(on_another.output, ::testing::ContainsRegex("devo operator .*, cycle 2, seed 7: .*stack overflow"));
}

TEST_F(Misbehaviour, ACrashIsNamedWithIndividualCycleAndSeed) {
  const auto crash = [&](const std::string& table, const std::string& how) {
    fs::remove_all(folder_);
    const Finished finished = testing::run(run_with(table, how));
    EXPECT_EQ(finished.exit_code, 128 + SIGSEGV) << finished.output;
    return finished.output;
  };
  EXPECT_THAT(
      crash("development.operator.0", "crash"),
      ::testing::ContainsRegex("devo operator \"misbehaves\" of .*, individual [0-5], cycle 2, seed 7: crashed"));
  EXPECT_THAT(crash("development.operator.0", "crash-when-asked"), HasSubstr(named("devo") + ", seed 7: crashed"));
  EXPECT_THAT(crash("encoding", "crash-in-layout"), HasSubstr(named("encoding") + ", seed 7: crashed"));
  EXPECT_THAT(crash("encoding", "crash"),
              ::testing::ContainsRegex("encoding operator .*, individual [0-5], seed 7: crashed"));
}

TEST_F(Misbehaviour, ACrashWhenTheRunEndsIsNamed) {
  const std::pair<std::string, std::string> tables[] = {{"encoding", "encoding"},
                                                        {"mutation.0", "mutation"},
                                                        {"development.operator.0", "devo"},
                                                        {"fitness.0", "fitness"}};
  for (const auto& [table, kind] : tables) {
    fs::remove_all(folder_);
    const Finished finished = testing::run(run_with(table, "crash-at-end"));
    EXPECT_EQ(finished.exit_code, 128 + SIGSEGV) << kind << finished.output;
    EXPECT_THAT(finished.output, HasSubstr(named(kind) + ": crashed"));
  }
}

TEST_F(Misbehaviour, WhatItChangesForAllIsPutBackAndNamed) {
  ASSERT_EQ(testing::run(mutating("well")).exit_code, 0);
  const double best = *Archive::read(folder_).generations().back().best;
  for (const char* how : {"round", "flush", "locale", "thread-locale", "global-locale"}) {
    fs::remove_all(folder_);
    const Finished finished = testing::run(mutating(how));
    EXPECT_EQ(finished.exit_code, 0) << how << finished.output;
    EXPECT_THAT(finished.output, HasSubstr("warning: " + named("mutation") + ": ")) << how;
    EXPECT_EQ(*Archive::read(folder_).generations().back().best, best) << how;
  }
}

TEST_F(Misbehaviour, OnlyOneProcessGoesOnAfterAFork) {
  ASSERT_EQ(testing::run(mutating("well")).exit_code, 0);
  const double best = *Archive::read(folder_).generations().back().best;
  for (const char* how : {"fork", "fork-and-throw"}) {
    fs::remove_all(folder_);
    const Finished finished = testing::run(mutating(how));
    EXPECT_EQ(finished.exit_code, 0) << how << finished.output;
    EXPECT_THAT(finished.output,
                HasSubstr("warning: " + named("mutation") + ", individual 6, seed 7: it called fork()"));
    const std::size_t line = finished.output.find("\ngeneration 2 ");
    EXPECT_NE(line, std::string::npos) << how << finished.output;
    EXPECT_EQ(finished.output.find("\ngeneration 2 ", line + 1), std::string::npos) << how << finished.output;
    EXPECT_EQ(*Archive::read(folder_).generations().back().best, best) << how;
  }
}

TEST_F(Misbehaviour, WhatNoLifeCanBeMeasuredByIsRefused) {
  const std::pair<const char*, const char*> cases[] = {
      {"no-window", "settle = 0 s and window = 0 s; expected"},
      {"endless-window", "settle = 0 s and window = no finite number; expected"},
      {"early-window", "settle = -0.1 s and window = 0.1 s; expected"},
      {"window-that-is-no-number", "settle = no finite number and window = 0.1 s; expected"},
      {"no-objective", "no scores"},
      {"nameless-objective", "an objective without a name"},
      {"descriptor-without-cells", "has bins = 0; expected 1 to 1000"},
      {"descriptor-with-too-many-cells", "has bins = 1001; expected 1 to 1000"},
      {"empty-descriptor", "has the range 1 to 1; expected"},
      {"samples-without-end", "11000000 samples per second for 0.1 s; expected"},
      {"samples-below-0", "-1 samples per second for 0.1 s; expected"},
      {"channels-without-samples", "Request::rate"},
      {"before-birth", "from cycle -1 of development on; expected 0 to 1"},
      {"after-the-last-cycle", "from cycle 1000 of development on; expected 0 to 1"},
      {"beyond-the-life", "until 10001 s of the life"},
      {"unknown-role", "the role 99"},
      {"twin-scores", "already a score \"one\""}};
  for (const auto& [how, reason] : cases) {
    const Finished finished = testing::run(run_with("fitness.0", how));
    EXPECT_EQ(finished.exit_code, 2) << how << finished.output;
    EXPECT_THAT(finished.output, HasSubstr("fitness.0.name = \"misbehaves\": ")) << how;
    EXPECT_THAT(finished.output, HasSubstr(reason)) << how;
    EXPECT_FALSE(fs::exists(folder_));
  }
  const Finished scores = testing::run(run_with("fitness.0", "one-score-too-many"));
  EXPECT_EQ(scores.exit_code, 1);
  EXPECT_THAT(scores.output, testing::naming("2 scores", "objectives() has 1"));
  EXPECT_THAT(scores.output, HasSubstr(named("fitness") + ", individual "));
}

TEST_F(Misbehaviour, ASelectionThatChoosesWronglyIsNamed) {
  const std::pair<const char*, const char*> cases[] = {{"no-parents", "Traits::chooses_parents"},
                                                       {"too-few-parents", "4 pairs of parents, expected 5"},
                                                       {"no-survivors", "Traits::chooses_survivors"}};
  for (const auto& [how, reason] : cases) {
    fs::remove_all(folder_);
    const Finished finished = testing::run(run_with("selection", how));
    EXPECT_EQ(finished.exit_code, 1) << how << finished.output;
    EXPECT_THAT(finished.output, testing::naming(named("selection"), reason)) << how;
  }
  fs::remove_all(folder_);
  for (const auto& [how, reason] : {std::pair("nameless-note", "notes()"), std::pair("twin-notes", "\"age\"")}) {
    const Finished finished = testing::run(run_with("selection", how));
    EXPECT_EQ(finished.exit_code, 2) << how << finished.output;
    EXPECT_THAT(finished.output, testing::naming("selection.name = \"misbehaves\": ", reason)) << how;
    EXPECT_FALSE(fs::exists(folder_));
  }
}

TEST_F(Misbehaviour, WhatItThrowsIsNamedWhereverItIsCalled) {
  for (const auto& [table, how] :
       {std::pair("encoding", "throw-in-layout"), std::pair("development.operator.0", "throw-when-asked")}) {
    const Finished finished = testing::run(run_with(table, how));
    EXPECT_EQ(finished.exit_code, 2) << finished.output;
    EXPECT_THAT(finished.output, testing::naming(std::string(table) + ".name = \"misbehaves\": ", "std::exception"));
  }
}

TEST_F(Misbehaviour, ABlueprintWithDoubledSpringsIsRefused) {
  const auto refused = [&](const char* how) {
    fs::remove_all(folder_);
    const Finished finished = testing::run(run_with("encoding", how));
    EXPECT_EQ(finished.exit_code, 1) << finished.output;
    EXPECT_THAT(finished.output, HasSubstr(named("encoding") + ", individual "));
    return finished.output;
  };
  EXPECT_THAT(refused("twin"), testing::naming("spring 3 ", "masses 1 and 2", "joined already"));
  EXPECT_THAT(refused("turned-twin"), testing::naming("spring 3 ", "masses 2 and 1", "joined already"));
  EXPECT_THAT(refused("loop"), testing::naming("spring 3 ", "itself"));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
