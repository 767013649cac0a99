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
#include "support/program.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using namespace testing;
using nlohmann::json;
using Outcomes = std::map<std::string, std::string>;

/// Returns the outcome of every case, followed by the reason if there is one.
Outcomes verdicts(const fs::path& library, int exit_code, const Words& options = {}) {
  const Words command = joined({"conform", library.string(), "--json"}, options);
  Outcomes outcomes;
  for (const json& verdict : json::parse(output_of(program(command), exit_code)))
    outcomes[verdict.at("case")] =
        verdict.at("outcome").get<std::string>() + " " + verdict.at("reason").get<std::string>();
  return outcomes;
}

fs::path faulty(const std::string& name) { return fs::path(EVODEVO_FAULTY_PLUGINS) / name / "plugin.evodevo.so"; }

/// Expects that cases passed, or were skipped since an operator cannot be asked.
void expect_kept(const Outcomes& outcomes, const std::string& or_since = "no parameters") {
  for (const auto& [name, outcome] : outcomes)
    EXPECT_THAT(outcome,
                ::testing::AnyOf("passed ", at_place("skipped ", "no parameters"), at_place("skipped ", or_since),
                                 at_place("skipped ", "overrides no survivors()")))
        << name;
}

class BuiltIn : public ::testing::TestWithParam<fs::path> {};

TEST_P(BuiltIn, KeepsToAllRules) {
  Words options;  // an experiment for the operator that requires a file
  if (GetParam().filename() == "cloud.evodevo.so") options = {"--experiment", EVODEVO_EXPERIMENTS "/cloud.toml"};
  const auto outcomes = verdicts(GetParam(), 0, options);
  EXPECT_GE(outcomes.size(), 12u);
  expect_kept(outcomes, "its traits say");
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

/// A plugin, texts that the reason must contain, and the rule that it breaks, with which its name begins.
struct Broken {
  std::string plugin;
  Words named;
  std::string rule = plugin.substr(0, plugin.find('_'));
};

class Wrong : public ::testing::TestWithParam<Broken> {};

TEST_P(Wrong, IsCaughtByTheCaseMeantForIt) {
  const auto& [plugin, named, rule] = GetParam();
  const Outcomes outcomes = verdicts(faulty("wrong_" + plugin), 1);
  EXPECT_EQ(outcomes.at("loads"), "passed ");
  EXPECT_THAT(outcomes.at(rule), ::testing::StartsWith(plugin == "crashing" ? "crashed " : "failed "));
  for (const std::string& part : named) EXPECT_THAT(outcomes.at(rule), ::testing::HasSubstr(part));
  if (plugin == "objectives_nan") {
    EXPECT_EQ(outcomes.at("translation"), "passed ") << "a score that is no number is the same elsewhere";
  }
}

INSTANTIATE_TEST_SUITE_P(
    Conformance, Wrong,
    ::testing::Values(
        Broken{"exports", {"another_export, evodevo_plugin", "evodevo_add_plugin"}}, Broken{"listing", {"ms", "100"}},
        Broken{"declarations", {"parameter \"genes\"", "full stop"}},
        Broken{"refusals", {"genes = 0.5", "parameters()"}}, Broken{"same_seed", {"input ", "Rng"}, "same-seed"},
        Broken{"threads", {"input 0 ", "thread"}}, Broken{"batch", {"input 12 "}}, Broken{"inputs", {"the layout"}},
        Broken{"instances", {"instance", "static"}}, Broken{"instances_prepared", {"instance", "static"}},
        Broken{"resuming", {"resumed"}}, Broken{"nothing", {"no genes"}}, Broken{"layout", {"gene 0 = 2,"}},
        Broken{"changes", {"200 genomes", "clones"}}, Broken{"changes_crossover", {"200 pairs", "clones"}},
        Broken{"twins", {"equal genomes"}}, Broken{"decoding", {"spring 0 "}},
        Broken{"decoding_springs", {"spring_memory[\"stem\"]", "Encoding::spring_memory()"}},
        Broken{"decoding_nothing", {"gives a body: never"}}, Broken{"bodies_destroyed", {"every body"}},
        Broken{"bodies", {"body 0, cycle 1: ", "masses "}},
        Broken{"bodies_dangling", {"body 0, cycle 1: ", "masses 0 and "}},
        Broken{"bodies_nan", {"body 0, cycle 1: ", "masses 0 and 1 ", "stiffness is not a number"}},
        Broken{"bodies_beyond", {"body 0: ", "bounds"}},
        Broken{"bodies_memory", {"body 0, cycle 1: ", "2 numbers", "mass 1", "mass_memory()"}},
        Broken{"decoding_memory", {"mass_memory[\"stem\"]", "3 numbers", "2 masses"}},
        Broken{"locality", {"body 0: without mass ", "locality", "at most 3"}},
        Broken{"bodies_scaling", {"body 0, cycle 1: ", "number 0", "spring_memory()"}},
        Broken{"translation", {"scores "}}, Broken{"nan_hidden", {"scores 0"}},
        Broken{"objectives", {"2 scores", "1 objectives"}}, Broken{"objectives_nan", {"20 bodies", "finite scores"}},
        Broken{"order", {"survivors", "order of the rows", "id"}},
        Broken{"order_ties", {"survivors", "order of the rows", "id"}},
        Broken{"order_memory", {"remembers", "order of the rows"}}, Broken{"elite", {"best first score"}},
        Broken{"failed", {"failed row"}}, Broken{"generations", {"survivors()", "different"}},
        Broken{"generations_note", {"finite", "notes()", "infinity"}},
        Broken{"generations_children", {"gene 0 = 1000"}},
        Broken{"generations_child", {"number 1 about child 23", "1 numbers", "notes()"}},
        Broken{"generations_memory", {"\"genes\"", "memory()"}},
        Broken{"hidden_state", {"input ", "calls"}, "hidden-state"}, Broken{"surroundings", {"the locale", "calls"}},
        Broken{"names", {"parameter \"genes\"", "<script>"}}, Broken{"names_control", {"parameter \"ge"}},
        Broken{"names_objective", {"name of an objective", "<b>way"}},
        Broken{"names_unit", {"unit of an objective", "control character"}},
        Broken{"names_measure", {"name of a measure", "<b>work"}},
        Broken{"crashing", {"Segmentation fault"}, "same-seed"}),
    [](const auto& broken) { return broken.param.plugin; });

TEST(Conformance, ChangesStayLocalWhereverSpringsAndMassesCome) {
  const Scratch scratch;
  std::ifstream file(EVODEVO_EXPERIMENTS "/quickstart.toml");
  const std::string quickstart(std::istreambuf_iterator<char>(file), {}),
      own = "name = \"spring-turnover\"\nsprings = 8";
  ASSERT_NE(quickstart.find(own), quickstart.npos);
  for (const auto& [name, keys] : {std::pair{"spring-turnover", "where = 'most-stressed'\nsprings = 125"},
                                   {"spring-turnover", "where = 'by-stress'\nsprings = 125"},
                                   {"mass-turnover", "where = 'by-stress'\njoin = 'nearest'"},
                                   {"mass-growth", "where = 'by-stress'"}}) {
    std::string text = quickstart;
    text.replace(text.find(own), own.size(), "name = \"" + std::string(name) + "\"\n" + keys);
    const Words options{"--experiment", scratch.write("experiment.toml", text), "--case", "locality"};
    EXPECT_EQ(verdicts(builtin_plugin_folder() / (std::string(name) + ".evodevo.so"), 0, options).at("locality"),
              "passed ")
        << name << " with " << keys;
  }
}

TEST(Conformance, ALibraryThatDoesNotLoadIsToldAlone) {
  const Outcomes outcomes = verdicts(faulty("undefined_symbol"), 1);
  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_THAT(outcomes.at("loads"), at_place("failed ", "loaded", "nobody"));
  EXPECT_THAT(testing::refusal({"conform", "/no/such"}), naming("conform /no/such: ", "NAME.evodevo.so"));
}

TEST(Conformance, WhatLoadingChangesIsAFaultThatNoExperimentHides) {
  for (const Words& options : {Words{}, {"--experiment", EVODEVO_EXPERIMENTS "/quickstart.toml"}})
    EXPECT_THAT(verdicts(faulty("rounds"), 1, options).at("loads"),
                at_place("failed ", "the rounding mode", "loaded", "-ffast-math"));
}

TEST(Conformance, ACaseThatNeverEndsIsNotKept) {
  Outcomes outcomes;
  const auto note = [&](const conformance::Verdict& verdict) {
    outcomes[verdict.name] = verdict.outcome + " " + verdict.reason;
  };
  conformance::examine({faulty("wrong_endless")}, {.seconds = 5}, note);
  EXPECT_THAT(outcomes.at("nothing"), at_place("failed ", " 5 s"));
  EXPECT_EQ(outcomes.at("layout"), "passed ") << "and the next case comes";
}

/// Returns the outcomes of the cases of one operator of the library of operators with special needs.
Outcomes special(const std::string& name, const Words& options = {}) {
  return verdicts(faulty("special"), 0, joined({"--operator", name}, options));
}

TEST(Conformance, BlocksOfAnEncodingOfTheSameLibraryRecordsOfMassesAndMemoryAreTried) {
  for (const std::string name : {"twigs", "feeling"}) expect_kept(special(name), "its traits say");
  const Outcomes bent = special("bend-twig");
  expect_kept(bent);
  EXPECT_THAT(bent.at("instances"), at_place("skipped ", "no parameters"));
  EXPECT_EQ(special("best").at("refusals"), "passed ") << "whose range is wider than the numbers tried";
  EXPECT_THAT(special("bend-leaf").at("changes"), at_place("skipped ", "\"leaf\"", "--experiment"));
}

TEST(Conformance, ARequiredFileComesFromTheExperiment) {
  const std::string text = testing::said({"conform", faulty("special").string(), "--operator", "by-file"});
  const std::size_t reason = text.find("--experiment");
  ASSERT_NE(reason, std::string::npos);
  EXPECT_EQ(text.find("--experiment", reason + 1), std::string::npos) << "a reason is told once:\n" << text;
  EXPECT_THAT(text, ::testing::HasSubstr(": as in "));
  const Outcomes without = special("by-file");
  EXPECT_THAT(without.at("threads"), at_place("skipped ", "\"file\"", "--experiment"));
  for (const auto& [name, outcome] : without)
    EXPECT_TRUE(name == "declarations" || name == "refusals" || name == "names" || outcome.starts_with("skipped "));
  const Scratch folder;
  folder.write("digits", "0369");
  const Outcomes outcomes = special("by-file", {"--experiment", folder.write("digits.toml", R"([experiment]
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
)")});
  EXPECT_GE(outcomes.size(), 12u);
  for (const auto& [name, outcome] : outcomes) EXPECT_EQ(outcome, "passed ") << name;
}

TEST(Conformance, AnExperimentThatDoesNotFitIsACase) {
  const Scratch folder;
  const std::string quickstart = EVODEVO_EXPERIMENTS "/quickstart.toml";
  std::ifstream stream(quickstart);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  text.insert(text.find("[experiment]\n") + std::string("[experiment]\n").size(), "spede = 1\n");
  const std::string bad = folder.write("bad.toml", text);
  const Outcomes outcomes = verdicts(faulty("wrong_changes"), 1, {"--experiment", bad, "--case", "changes"});
  ASSERT_EQ(outcomes.size(), 1u);
  EXPECT_THAT(outcomes.at("experiment"), at_place("failed " + bad, "spede"));
  const Words without{"conform", faulty("wrong_changes").string(), "--experiment", quickstart};
  EXPECT_THAT(output_of(program(without), 1),
              naming("failed   " + quickstart, "experiment: ", "no operator of the libraries"));
}

TEST(Conformance, OneCaseCanRunInThisProcess) {
  EXPECT_EQ(special("twigs", {"--case", "decoding", "--here"}), (Outcomes{{"decoding", "passed "}}));
  const std::string crashing = faulty("wrong_crashing").string();
  EXPECT_GT(testing::evodevo({"conform", crashing, "--case", "batch", "--here"}).exit_code, 2)
      << "the crash is that of the program";
  EXPECT_THAT(testing::refusal({"conform", crashing, "--here"}), naming("--here: ", "--case"));
  EXPECT_THAT(testing::refusal({"conform", crashing, "--case", "btach"}), naming("--case btach: ", "names"));
}

TEST(Reference, ThePageIsWhatThePluginsSay) {
  std::ifstream page(EVODEVO_REFERENCE_PAGE);
  const std::string text{std::istreambuf_iterator<char>(page), {}};
  EXPECT_EQ(text, said({"operators", "--markdown"}))
      << "renew it: tools/evodevo operators --markdown > plugins/README.md";
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
