// The conformance kit: all built-in operators pass it, and each wrong plugin fails the case meant for it.
#include "conformance/conformance.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "operators/loader.hpp"
#include "support/messages.hpp"
#include "support/process.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::Finished;

/// Returns the outcome of every case, followed by the reason if there is one.
std::map<std::string, std::string> verdicts(const fs::path& library, int expected_exit,
                                            const std::vector<std::string>& options = {}) {
  std::vector<std::string> command = {EVODEVO_PROGRAM, "conform", library.string(), "--json"};
  command.insert(command.end(), options.begin(), options.end());
  const Finished finished = testing::run(command);
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
  std::vector<std::string> options;  // an experiment for the operator that requires a file
  if (GetParam().filename() == "cloud.evodevo.so") options = {"--experiment", EVODEVO_EXPERIMENTS "/cloud.toml"};
  const auto outcomes = verdicts(GetParam(), 0, options);
  EXPECT_GE(outcomes.size(), 12u);
  for (const auto& [name, outcome] : outcomes)
    EXPECT_THAT(outcome, ::testing::AnyOf("passed ", testing::at_place("skipped ", "no parameters"),
                                          testing::at_place("skipped ", "its traits say")))
        << name;
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
  std::string outcome;             ///< expected outcome
  std::vector<std::string> named;  ///< texts that the reason must contain
};

class Wrong : public ::testing::TestWithParam<Broken> {};

TEST_P(Wrong, IsCaughtByTheCaseMeantForIt) {
  const auto outcomes = verdicts(wrong(GetParam().plugin), 1);
  EXPECT_EQ(outcomes.at("loads"), "passed ");
  EXPECT_THAT(outcomes.at(GetParam().rule), ::testing::StartsWith(GetParam().outcome + " "));
  for (const std::string& part : GetParam().named)
    EXPECT_THAT(outcomes.at(GetParam().rule), ::testing::HasSubstr(part));
}

INSTANTIATE_TEST_SUITE_P(
    Conformance, Wrong,
    ::testing::Values(
        Broken{"exports", "exports", "failed", {"another_export, evodevo_plugin", "evodevo_add_plugin"}},
        Broken{"listing", "listing", "failed", {"ms", "100"}},
        Broken{"declarations", "declarations", "failed", {"parameter \"genes\"", "full stop"}},
        Broken{"refusals", "refusals", "failed", {"genes = 0.5", "parameters()"}},
        Broken{"same_seed", "same-seed", "failed", {"input ", "Rng"}},
        Broken{"threads", "threads", "failed", {"input 0 ", "thread"}},
        Broken{"batch", "batch", "failed", {"input 12 "}}, Broken{"inputs", "inputs", "failed", {"the layout"}},
        Broken{"instances", "instances", "failed", {"instance", "static"}},
        Broken{"instances_prepared", "instances", "failed", {"instance", "static"}},
        Broken{"resuming", "resuming", "failed", {"resumed"}}, Broken{"nothing", "nothing", "failed", {"no genes"}},
        Broken{"layout", "layout", "failed", {"gene 0 = 2,"}},
        Broken{"changes", "changes", "failed", {"200 genomes", "clones"}},
        Broken{"changes_crossover", "changes", "failed", {"200 pairs", "clones"}},
        Broken{"twins", "twins", "failed", {"equal genomes"}}, Broken{"decoding", "decoding", "failed", {"spring 0 "}},
        Broken{"decoding_growth", "decoding", "failed", {"sets_growth()"}},
        Broken{"decoding_nothing", "decoding", "failed", {"gives a body: never"}},
        Broken{"bodies_destroyed", "bodies", "failed", {"every body"}},
        Broken{"bodies", "bodies", "failed", {"body 0, cycle 1: ", "masses "}},
        Broken{"bodies_dangling", "bodies", "failed", {"body 0, cycle 1: ", "masses 0 and "}},
        Broken{"bodies_nan", "bodies", "failed", {"body 0, cycle 1: ", "masses 0 and 1 ", "stiffness is not a number"}},
        Broken{"bodies_beyond", "bodies", "failed", {"body 0: ", "bounds"}},
        Broken{"bodies_memory", "bodies", "failed", {"body 0, cycle 1: ", "Edits::mass_memory", "mass_memory()"}},
        Broken{"decoding_memory", "decoding", "failed", {"mass_memory[\"stem\"]", "3 numbers", "2 masses"}},
        Broken{"bodies_growth", "bodies", "failed", {"uses_growth()"}},
        Broken{"translation", "translation", "failed", {"scores "}},
        Broken{"nan_hidden", "nan", "failed", {"scores 0"}},
        Broken{"objectives", "objectives", "failed", {"2 scores", "1 objectives"}},
        Broken{"objectives_nan", "objectives", "failed", {"20 bodies", "finite scores"}},
        Broken{"order", "order", "failed", {"order of birth"}},
        Broken{"order_memory", "order", "failed", {"children", "order of birth"}},
        Broken{"elite", "elite", "failed", {"best first score"}}, Broken{"failed", "failed", "failed", {"failed row"}},
        Broken{"generations", "generations", "failed", {"survive()", "different"}},
        Broken{"generations_note", "generations", "failed", {"finite", "notes()", "infinity"}},
        Broken{"generations_children", "generations", "failed", {"gene 0 = 1000"}},
        Broken{"generations_memory", "generations", "failed", {"memory", "needs_memory"}},
        Broken{"hidden_state", "hidden-state", "failed", {"input ", "calls"}},
        Broken{"surroundings", "surroundings", "failed", {"the locale", "calls"}},
        Broken{"names", "names", "failed", {"parameter \"genes\"", "<script>"}},
        Broken{"names_control", "names", "failed", {"parameter \"ge"}},
        Broken{"names_objective", "names", "failed", {"name of an objective", "<b>way"}},
        Broken{"names_unit", "names", "failed", {"unit of an objective", "control character"}},
        Broken{"names_measure", "names", "failed", {"name of a measure", "<b>work"}},
        Broken{"crashing", "same-seed", "crashed", {"Segmentation fault"}}),
    [](const auto& broken) { return std::string(broken.param.plugin); });

TEST(Conformance, AScoreThatIsNoNumberIsTheSameElsewhere) {
  EXPECT_EQ(verdicts(wrong("objectives_nan"), 1).at("translation"), "passed ");
}

TEST(Conformance, ALibraryThatDoesNotLoadIsToldAlone) {
  const auto outcomes = verdicts(fs::path(EVODEVO_FAULTY_PLUGINS) / "undefined_symbol" / "plugin.evodevo.so", 1);
  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_THAT(outcomes.at("loads"), testing::at_place("failed ", "loaded", "nobody"));
  const Finished none = testing::run({EVODEVO_PROGRAM, "conform", "/no/such"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.output, testing::naming("conform /no/such: ", "NAME.evodevo.so"));
}

TEST(Conformance, WhatLoadingChangesIsAFault) {
  const auto outcomes = verdicts(fs::path(EVODEVO_FAULTY_PLUGINS) / "rounds" / "plugin.evodevo.so", 1);
  EXPECT_THAT(outcomes.at("loads"), testing::at_place("failed ", "the rounding mode", "loaded", "-ffast-math"));
}

TEST(Conformance, ACaseThatNeverEndsIsNotKept) {
  std::map<std::string, std::string> outcomes;
  const auto note = [&](const conformance::Verdict& verdict) {
    outcomes[verdict.name] = verdict.outcome + " " + verdict.reason;
  };
  conformance::examine({wrong("endless")}, {.seconds = 5}, note);
  EXPECT_THAT(outcomes.at("nothing"), testing::at_place("failed ", " 5 s"));
  EXPECT_EQ(outcomes.at("layout"), "passed ") << "and the next case comes";
}

/// Returns the outcomes of the cases of one operator of the library of operators with special needs.
std::map<std::string, std::string> special(const std::string& name, std::vector<std::string> options = {}) {
  const fs::path library = fs::path(EVODEVO_FAULTY_PLUGINS) / "special" / "plugin.evodevo.so";
  options.insert(options.begin(), {"--operator", name});
  return verdicts(library, 0, options);
}

bool is_all_skipped(const std::map<std::string, std::string>& outcomes, const std::vector<std::string>& but) {
  return std::ranges::all_of(outcomes, [&](const auto& one) {
    return std::ranges::count(but, one.first) > 0 || one.second.starts_with("skipped ");
  });
}

TEST(Conformance, BlocksOfAnEncodingOfTheSameLibraryAreTried) {
  for (const std::string name : {"twigs", "bend-twig"})
    for (const auto& [one, outcome] : special(name))
      EXPECT_THAT(outcome, ::testing::AnyOf("passed ", testing::at_place("skipped ", "no parameters"))) << one;
}

TEST(Conformance, RecordsOfMassesAndMemoryAreTried) {
  for (const auto& [one, outcome] : special("feeling"))
    EXPECT_THAT(outcome, ::testing::AnyOf("passed ", testing::at_place("skipped ", "no parameters"))) << one;
}

TEST(Conformance, RangesThatAreWiderThanTheNumbersTriedAreRight) {
  EXPECT_EQ(special("best").at("refusals"), "passed ");
}

TEST(Conformance, BlocksThatNobodyHasAreMissed) {
  EXPECT_THAT(special("bend-leaf").at("changes"), testing::at_place("skipped ", "\"leaf\"", "--experiment"));
}

TEST(Conformance, ARequiredFileComesFromTheExperiment) {
  const auto without = special("by-file");
  EXPECT_THAT(without.at("threads"), testing::at_place("skipped ", "\"file\"", "--experiment"));
  EXPECT_TRUE(is_all_skipped(without, {"declarations", "refusals", "names"}));
  const testing::Scratch folder;
  folder.write("digits", "0369");
  const std::string experiment = folder.write("digits.toml", R"([experiment]
evaluations = 10
[encoding]
name = "twigs"
[[mutation]]
name = "by-file"
file = "digits"
[[fitness]]
name = "distance"
[selection]
name = "elitist"
)");
  const auto outcomes = special("by-file", {"--experiment", experiment});
  EXPECT_GE(outcomes.size(), 12u);
  for (const auto& [name, outcome] : outcomes) EXPECT_EQ(outcome, "passed ") << name;
}

TEST(Conformance, AnExperimentHidesNoFaultOfALibrary) {
  const fs::path library = fs::path(EVODEVO_FAULTY_PLUGINS) / "rounds" / "plugin.evodevo.so";
  const auto outcomes = verdicts(library, 1, {"--experiment", EVODEVO_EXPERIMENTS "/quickstart.toml"});
  EXPECT_THAT(outcomes.at("loads"), testing::at_place("failed ", "the rounding mode"));
}

TEST(Conformance, AnExperimentThatCannotBeReadIsACase) {
  const testing::Scratch folder;
  std::ifstream quickstart(EVODEVO_EXPERIMENTS "/quickstart.toml");
  std::string text{std::istreambuf_iterator<char>(quickstart), {}};
  text.insert(text.find("[experiment]\n") + std::string("[experiment]\n").size(), "spede = 1\n");
  const std::string experiment = folder.write("bad.toml", text);
  const auto outcomes = verdicts(wrong("changes"), 1, {"--experiment", experiment, "--case", "changes"});
  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_THAT(outcomes.at("experiment"), testing::at_place("failed " + experiment, "spede"));
}

TEST(Conformance, AnExperimentWithoutTheOperatorsIsRefused) {
  const std::string other = EVODEVO_EXPERIMENTS "/quickstart.toml";
  const Finished finished =
      testing::run({EVODEVO_PROGRAM, "conform", wrong("changes").string(), "--experiment", other});
  EXPECT_EQ(finished.exit_code, 1);
  EXPECT_THAT(finished.output, testing::naming("failed   " + other, "experiment: ", "no operator of the libraries"));
}

TEST(Conformance, OneCaseCanRunInThisProcess) {
  EXPECT_EQ(special("twigs", {"--case", "decoding", "--here"}),
            (std::map<std::string, std::string>{{"decoding", "passed "}}));
  const std::string crashing = wrong("crashing").string();
  const Finished here = testing::run({EVODEVO_PROGRAM, "conform", crashing, "--case", "batch", "--here"});
  EXPECT_GT(here.exit_code, 2) << "the crash is that of the program";
  const Finished no_case = testing::run({EVODEVO_PROGRAM, "conform", crashing, "--here"});
  EXPECT_EQ(no_case.exit_code, 2);
  EXPECT_THAT(no_case.output, testing::naming("--here: ", "--case"));
  const Finished unknown = testing::run({EVODEVO_PROGRAM, "conform", crashing, "--case", "btach"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.output, testing::naming("--case btach: ", "names"));
}

TEST(Conformance, ACaseThatCannotSayAnythingIsSkipped) {
  const auto outcomes = verdicts(builtin_plugin_folder() / "swap-neuron.evodevo.so", 0);
  EXPECT_THAT(outcomes.at("instances"), testing::at_place("skipped ", "no parameters"));
}

TEST(Reference, ThePageIsWhatThePluginsSay) {
  const Finished finished = testing::run({EVODEVO_PROGRAM, "operators", "--markdown"});
  ASSERT_EQ(finished.exit_code, 0);
  std::ifstream page(EVODEVO_REFERENCE_PAGE);
  const std::string text{std::istreambuf_iterator<char>(page), {}};
  EXPECT_EQ(text, finished.output) << "renew it: tools/evodevo operators --markdown > plugins/README.md";
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
