// Help, completion and the manual page agree with the declarations of the commands; options control how much a command
// prints.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "commands/commands.hpp"
#include "commands/shell/topics.hpp"
#include "core/slow_step.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/program.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using namespace testing;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;

Words names_of_options(const Command& command) {
  Words names;
  for (const Options* options : {&command.options, &common_options()})
    for (const auto& option : options->options()) names.push_back("--" + option->long_name());
  return names;
}

bool is_installed(const std::string& program) {
  return testing::run({"sh", "-c", "command -v " + program}).exit_code == 0;
}

TEST(Help, TheFirstPageHasEveryCommandAndTopicAndEachExplainsItself) {
  const std::string first = said({"--help"});
  EXPECT_EQ(evodevo({"help"}).output, first);
  EXPECT_EQ(refusal({}), first);
  for (const Command& command : commands()) {
    EXPECT_THAT(first, naming("evodevo " + call_of(command) + " ", command.summary + "\n"));
    const std::string page = said({command.name, "--help"});
    EXPECT_THAT(page, HasSubstr("usage: evodevo " + call_of(command)));
    for (const std::string& option : names_of_options(command)) EXPECT_THAT(page, HasSubstr("  " + option));
    ASSERT_FALSE(command.examples.empty()) << command.name;
    for (const std::string& example : command.examples) {
      EXPECT_THAT(page, HasSubstr("  evodevo " + example));
      std::istringstream line(example.substr(0, example.find_first_of(">|")));
      Words words;
      for (std::string word; line >> word;) words.push_back(word);
      ASSERT_EQ(words.front(), command.name);
      EXPECT_NO_THROW(parse(command, {words.begin() + 1, words.end()})) << example;
    }
    EXPECT_EQ(evodevo({"help", command.name}).output, page);
  }
  for (const Topic& topic : topics()) {
    EXPECT_THAT(first, HasSubstr("evodevo help " + topic.name + " "));
    const std::string page = said({"help", topic.name});
    for (const Definition& definition : topic.definitions) EXPECT_THAT(page, HasSubstr(definition.term));
    EXPECT_THAT(page, HasSubstr(topic.example));
    std::istringstream lines(page);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
  }
  EXPECT_THAT(refusal({"help", "archiv"}), naming("help archiv: ", "did you mean \"archive\"?"));
}

TEST(Help, TheExperimentOfTheTopicRuns) {
  const Topic& topic = *std::ranges::find(topics(), "experiment", &Topic::name);
  const Scratch scratch;
  said({"check", scratch.write("topic.toml", topic.example)});
}

/// Returns the lines that a command prints; expects that it succeeds.
Words lines_of(const Words& command) {
  std::istringstream stream(output_of(command));
  Words lines;
  for (std::string line; std::getline(stream, line);)
    if (!line.empty()) lines.push_back(line);
  return lines;
}

class Completion : public ::testing::Test {
 protected:
  Completion() {
    for (const std::string shell : {"bash", "zsh", "fish"})
      scratch_.write("script." + shell, said({"completion", shell}));
    fs::create_directory(scratch_ / "folder");
    scratch_.write("file.toml", "");
  }

  /// Returns the completions that bash offers for the last of these words.
  Words offered(const Words& words) const {
    const std::string complete =
        "cd \"$1\" && source script.bash && shift && COMP_WORDS=(\"$@\") && "
        "COMP_CWORD=$(($# - 1)) && { _evodevo \"$1\"; printf '%s\\n' \"${COMPREPLY[@]}\"; }";
    return lines_of(joined({"bash", "-c", complete, "bash", (scratch_ / "").string(), EVODEVO_PROGRAM}, words));
  }

  std::string script(const std::string& shell) const { return (scratch_ / ("script." + shell)).string(); }

  Scratch scratch_;
};

TEST_F(Completion, BashKnowsCommandsOptionsValuesFoldersAndFiles) {
  EXPECT_THAT(lines_of({"bash", "-c", "source \"$0\" && complete -p evodevo", script("bash")}),
              ElementsAre("complete -F _evodevo evodevo"));
  const auto all = offered({""});
  for (const Command& command : commands()) {
    EXPECT_THAT(all, Contains(command.name));
    EXPECT_THAT(offered({command.name, "--"}), ::testing::UnorderedElementsAreArray(names_of_options(command)));
  }
  EXPECT_THAT(offered({"sim"}), ElementsAre("simulate"));
  EXPECT_THAT(offered({"run", "--device", ""}), ElementsAre("auto", "cpu", "cuda"));
  EXPECT_THAT(offered({"run", "--seed", ""}), IsEmpty());
  EXPECT_THAT(offered({"show", ""}), ElementsAre("folder"));
  EXPECT_THAT(offered({"check", ""}), IsSupersetOf({"folder", "file.toml"}));
  EXPECT_THAT(offered({"run", "file.toml", "--out", "f"}), ElementsAre("folder"));
  EXPECT_THAT(offered({"describe", "spring-t"}), ElementsAre("spring-turnover"));
  EXPECT_THAT(offered({"describe", "--markdown", "spring-t"}), ElementsAre("spring-turnover"));
  EXPECT_THAT(offered({"new", "d"}), ElementsAre("devo"));
  EXPECT_THAT(offered({"new", "devo", ""}), IsEmpty()) << "the name is the user's own";
  EXPECT_THAT(offered({"new", "devo", "my-lab.growth", "--quiet", "f"}), ElementsAre("fitness"));
  EXPECT_THAT(offered({"new", "devo", "my-lab.growth", "fitness", ""}), IsEmpty());
  EXPECT_THAT(offered({"help", "ex"}), ElementsAre("experiment", "exit-codes"));
}

TEST_F(Completion, ZshLoadsTheScript) {
  if (!is_installed("zsh")) GTEST_SKIP() << "there is no zsh";
  EXPECT_THAT(lines_of({"zsh", "-n", script("zsh")}), IsEmpty());
  const std::string load = "autoload -Uz compinit && compinit -D && source \"$0\" && print $_comps[evodevo]";
  EXPECT_THAT(lines_of({"zsh", "-fc", load, script("zsh")}), ElementsAre("_evodevo"));
}

TEST_F(Completion, FishCompletes) {
  if (!is_installed("fish")) GTEST_SKIP() << "there is no fish";
  const auto fish_offers = [&](const std::string& line) {
    const std::string complete =
        "cd \"$0\" && export HOME=$0 PATH=\"$1:$PATH\" && fish -c 'source script.fish; complete -C \"'\"$2\"'\"'";
    Words lines = lines_of(
        {"sh", "-c", complete, (scratch_ / "").string(), fs::path(EVODEVO_PROGRAM).parent_path().string(), line});
    for (std::string& offer : lines) offer = offer.substr(0, offer.find('\t'));  // the explanation follows the tab
    return lines;
  };
  EXPECT_THAT(fish_offers("evodevo sim"), ElementsAre("simulate"));
  for (const Command& command : commands())
    EXPECT_THAT(fish_offers("evodevo " + command.name + " --"), IsSupersetOf(names_of_options(command)));
  EXPECT_THAT(fish_offers("evodevo run --device "), ElementsAre("auto", "cpu", "cuda"));
  EXPECT_THAT(fish_offers("evodevo describe spring-t"), ElementsAre("spring-turnover"));
  EXPECT_THAT(fish_offers("evodevo show "), ElementsAre("folder/"));
}

TEST_F(Completion, OtherShellsAreRefused) {
  EXPECT_THAT(refusal({"completion", "csh"}), naming("completion csh: ", "bash"));
}

TEST(Manual, HasEveryCommandOptionExampleAndTopicInGoodRoff) {
  const std::string page = said({"man"});
  const auto escaped = [](std::string text) {
    for (std::size_t at = 0; (at = text.find('-', at)) != text.npos; at += 2) text.replace(at, 1, "\\-");
    return text;
  };
  for (const Command& command : commands()) {
    EXPECT_THAT(page, HasSubstr(".SS evodevo " + escaped(call_of(command))));
    for (const std::string& option : names_of_options(command))
      EXPECT_THAT(page, HasSubstr("\\fB" + escaped(option) + "\\fR"));
  }
  EXPECT_THAT(page, naming(".SH ENVIRONMENT", "EVODEVO_PLUGIN_PATH", ".SH EXIT CODES", ".SH EXPERIMENT"));
  if (!is_installed("groff")) GTEST_SKIP() << "there is no groff";
  const Scratch scratch;
  const std::string file = scratch.write("evodevo.1", page);
  EXPECT_THAT(lines_of({"groff", "-man", "-ww", "-z", "-Tascii", file}), IsEmpty());
  EXPECT_THAT(testing::run({"groff", "-man", "-Tascii", "-P-cbou", file}).output,
              naming("--allow-other-versions", "\n       [experiment]\n"));
}

TEST(Verbosity, QuietPrintsResultsAloneAndVerboseSaysWhatTakesHowLong) {
  const Scratch scratch;
  const std::string file = scratch.write("small.toml", small_experiment);
  const auto run = [&](const std::string& option) {
    return lines_of(program({"run", file, "--out", (scratch / option).string(), option}));
  };
  const Words quiet = run("--quiet");
  ASSERT_EQ(quiet.size(), 2u + 16u) << "the best, its verification and its trials";
  EXPECT_THAT(quiet[0], naming("best: individual ", (scratch / "--quiet").string()));
  EXPECT_THAT(quiet[1], ::testing::StartsWith("individual "));
  const Words verbose = run("--verbose");
  for (const std::string what : {"loading its operators", "simulator", "verifying"})
    EXPECT_THAT(verbose, Contains(::testing::ContainsRegex("^evodevo: .*" + what + ".* took [0-9.e-]+ s$")));
  const Finished shown =
      testing::run({"sh", "-c", "exec \"$0\" operators --json --verbose 2>/dev/null", EVODEVO_PROGRAM});
  EXPECT_TRUE(nlohmann::json::accept(shown.output)) << "notices do not mix with results";
  EXPECT_THAT(refusal({"operators", "--quiet", "--verbose"}), naming("--quiet", "--verbose", "give one"));

  // the topic of verification names the trials
  const std::string page = said({"help", "verification"});
  const std::string verified = said({"verify", (scratch / "--quiet").string(), "--best", "1", "--json"});
  for (const auto& trial : nlohmann::json::parse(verified)[0].at("trials"))
    EXPECT_THAT(page, HasSubstr(trial.at("trial").get<std::string>()));
}

TEST(SlowSteps, AreToldToTheListenerFromBeginToEnd) {
  { const SlowStep unheard("nobody listens"); }
  Words told;
  set_slow_step_listener([&](std::string_view what, std::optional<double> seconds) {
    told.push_back(std::string(what) + (seconds ? " ends" : " begins"));
    EXPECT_GE(seconds.value_or(0), 0);
  });
  {
    const SlowStep step("compiling");
    told.emplace_back("work");
  }
  set_slow_step_listener(nullptr);
  EXPECT_THAT(told, ElementsAre("compiling begins", "work", "compiling ends"));
}

TEST(Version, NamesTheBuildAndWhatItCanUse) {
  const std::string version = said({"--version"});
  EXPECT_THAT(version, at_place("evodevo " EVODEVO_VERSION "\nbuild: ", "\nfeatures: CUDA ", ", MPI ", ", viewer ",
                                "\ndevices: cpu, ", "core"));
#ifndef EVODEVO_CUDA
  EXPECT_THAT(version, naming("CUDA no", "no GPU: ", "without CUDA"));
#endif
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
