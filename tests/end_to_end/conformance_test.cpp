// The conformance kit: all built-in operators pass it, and each wrong plugin fails the case meant for it.
#include "conformance/conformance.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "operators/loader.hpp"
#include "support/process.hpp"
#include "support/scratch.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::Finished;

/// Returns the outcome of every case, followed by the reason if there is one.
std::map<std::string, std::string> verdicts(const fs::path& library, int expected_exit) {
  const Finished finished = testing::run({EVODEVO_PROGRAM, "conform", library.string(), "--json"});
  EXPECT_EQ(finished.exit_code, expected_exit) << finished.output;
  std::map<std::string, std::string> outcomes;
  for (const json& verdict : json::parse(finished.output))
    outcomes[verdict.at("case")] =
        verdict.at("outcome").get<std::string>() + " " + verdict.at("reason").get<std::string>();
  return outcomes;
}

fs::path wrong(const std::string& rule) {
  return fs::path(EVODEVO_FAULTY_PLUGINS) / ("wrong_" + rule) / "plugin.evodevo.so";
}

class BuiltIn : public ::testing::TestWithParam<fs::path> {};

TEST_P(BuiltIn, KeepsToAllRules) {
  const auto outcomes = verdicts(GetParam(), 0);
  EXPECT_GE(outcomes.size(), 12u);
  for (const auto& [name, outcome] : outcomes)
    EXPECT_THAT(outcome, ::testing::AnyOf("passed ", "skipped it has no parameters")) << name;
}

std::set<fs::path> built_in_libraries() {
  const fs::directory_iterator folder(builtin_plugin_folder());
  return {begin(folder), end(folder)};
}

INSTANTIATE_TEST_SUITE_P(Conformance, BuiltIn, ::testing::ValuesIn(built_in_libraries()), [](const auto& library) {
  std::string name = library.param.stem().stem();
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

struct Broken {
  const char* plugin;
  const char* rule;
  const char* verdict;  ///< beginning of the expected verdict
};

class Wrong : public ::testing::TestWithParam<Broken> {};

TEST_P(Wrong, IsCaughtByTheCaseMeantForIt) {
  const auto outcomes = verdicts(wrong(GetParam().plugin), 1);
  EXPECT_EQ(outcomes.at("loads"), "passed ");
  EXPECT_THAT(outcomes.at(GetParam().rule), ::testing::StartsWith(GetParam().verdict));
}

INSTANTIATE_TEST_SUITE_P(
    Conformance, Wrong,
    ::testing::Values(
        Broken{"exports", "exports", "failed exports another_export, evodevo_plugin; expected evodevo_plugin alone"},
        Broken{"listing", "listing", "failed listing it takes "},
        Broken{"declarations", "declarations", "failed parameter \"genes\" has no sentence"},
        Broken{"refusals", "refusals", "failed it accepts genes = 0.5"},
        Broken{"same_seed", "same-seed", "failed two calls with input "},
        Broken{"threads", "threads", "failed input 0 gives one result on one thread and another on eight"},
        Broken{"batch", "batch", "failed input 12 alone and after others gives different results"},
        Broken{"inputs", "inputs", "failed it changes the layout, which it may only read"},
        Broken{"instances", "instances", "failed a parameter set in one instance changes in another"},
        Broken{"resuming", "resuming", "failed a run that was stopped and resumed ends otherwise"},
        Broken{"nothing", "nothing", "failed it makes genes of no genes"},
        Broken{"layout", "layout", "failed gene 0 = 2 is not of the layout"},
        Broken{"changes", "changes", "failed it changes none of 200 genomes"},
        Broken{"changes_crossover", "changes", "failed of 200 pairs of genomes it changes the first in none"},
        Broken{"twins", "twins", "failed of two equal genomes it makes others"},
        Broken{"decoding", "decoding", "failed spring 0 dangles"},
        Broken{"decoding_growth", "decoding", "failed springs may grow, but sets_growth() denies it"},
        Broken{"bodies", "bodies", "failed body 0, cycle 1: it joins masses "},
        Broken{"bodies_dangling", "bodies", "failed body 0, cycle 1: it joins masses 0 and "},
        Broken{"bodies_nan", "bodies",
               "failed body 0, cycle 1: it joins masses 0 and 1 by a spring whose stiffness is not a number"},
        Broken{"bodies_beyond", "bodies", "failed body 0: a new mass lies beyond the bounds"},
        Broken{"bodies_growth", "bodies", "failed it lets springs grow, but uses_growth() denies it"},
        Broken{"translation", "translation", "failed a body that does the same elsewhere scores "},
        Broken{"nan_hidden", "nan", "failed an observation without a single number scores 0"},
        Broken{"objectives", "objectives", "failed it gives 2 scores for 1 objectives"},
        Broken{"objectives_nan", "objectives", "failed none of 20 bodies gets finite scores"},
        Broken{"order", "order", "failed who lives on depends on the order of birth"},
        Broken{"elite", "elite", "failed the row with the best first score does not live on"},
        Broken{"failed", "failed", "failed a failed row lives on instead of a sound one"},
        Broken{"hidden_state", "hidden-state", "failed input "},
        Broken{"surroundings", "surroundings", "failed it changes the locale in its calls"},
        Broken{"names", "names", "failed the declaration of parameter \"genes\" has markup: <script>"},
        Broken{"names_control", "names", "failed the parameter \"ge"},
        Broken{"crashing", "same-seed", "crashed Segmentation fault"}),
    [](const auto& broken) { return std::string(broken.param.plugin); });

TEST(Conformance, AScoreThatIsNoNumberIsTheSameElsewhere) {
  EXPECT_EQ(verdicts(wrong("objectives_nan"), 1).at("translation"), "passed ");
}

TEST(Conformance, ALibraryThatDoesNotLoadIsToldAlone) {
  const auto outcomes = verdicts(fs::path(EVODEVO_FAULTY_PLUGINS) / "undefined_symbol" / "plugin.evodevo.so", 1);
  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_THAT(outcomes.at("loads"), ::testing::StartsWith("failed cannot be loaded: "));
  const Finished none = testing::run({EVODEVO_PROGRAM, "conform", "/no/such"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.output,
              ::testing::AllOf(::testing::HasSubstr("conform /no/such: "), ::testing::HasSubstr("NAME.evodevo.so")));
}

TEST(Conformance, WhatLoadingChangesIsAFault) {
  const auto outcomes = verdicts(fs::path(EVODEVO_FAULTY_PLUGINS) / "rounds" / "plugin.evodevo.so", 1);
  EXPECT_THAT(outcomes.at("loads"), ::testing::StartsWith("failed it changes the rounding mode while it is loaded"));
}

TEST(Conformance, ACaseThatNeverEndsIsNotKept) {
  std::map<std::string, std::string> outcomes;
  const auto note = [&](const conformance::Verdict& verdict) {
    outcomes[verdict.name] = verdict.outcome + " " + verdict.reason;
  };
  conformance::examine(wrong("endless"), 1, note, 1);
  EXPECT_THAT(outcomes.at("nothing"), ::testing::StartsWith("failed not done after 1 s"));
  EXPECT_EQ(outcomes.at("layout"), "passed ") << "and the next case comes";
}

TEST(Conformance, ACaseThatCannotSayAnythingIsSkipped) {
  const auto outcomes = verdicts(builtin_plugin_folder() / "swap-neuron.evodevo.so", 0);
  EXPECT_EQ(outcomes.at("instances"), "skipped it has no parameters");
}

TEST(Reference, ThePageIsWhatThePluginsSay) {
  const Finished finished = testing::run({EVODEVO_PROGRAM, "operators", "--markdown"});
  ASSERT_EQ(finished.exit_code, 0);
  std::ifstream page(EVODEVO_REFERENCE_PAGE);
  const std::string text{std::istreambuf_iterator<char>(page), {}};
  EXPECT_EQ(text, finished.output) << "renew it: tools/evodevo operators --markdown > plugins/README.md";
}

}  // namespace
}  // namespace evodevo
