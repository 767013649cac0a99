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
#include "support/process.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using testing::Finished;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;
using ::testing::Not;
using testing::small_experiment;

Finished evodevo(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), EVODEVO_PROGRAM);
  return testing::run(arguments);
}

std::vector<std::string> names_of_options(const Command& command) {
  std::vector<std::string> names;
  for (const Options* options : {&command.options, &common_options()})
    for (const auto& option : options->options()) names.push_back("--" + option->long_name());
  return names;
}

const Topic& topic_named(const std::string& name) {
  return *std::find_if(topics().begin(), topics().end(), [&](const Topic& topic) { return topic.name == name; });
}

bool is_installed(const std::string& program) {
  return testing::run({"sh", "-c", "command -v " + program}).exit_code == 0;
}

TEST(Help, TheFirstPageHasEveryCommandAndTopic) {
  const Finished page = evodevo({"--help"});
  EXPECT_EQ(page.exit_code, 0);
  for (const Command& command : commands())
    EXPECT_THAT(page.output, AllOf(HasSubstr("evodevo " + call_of(command) + " "), HasSubstr(command.summary + "\n")));
  for (const Topic& topic : topics()) EXPECT_THAT(page.output, HasSubstr("evodevo help " + topic.name + " "));
  EXPECT_EQ(evodevo({"help"}).output, page.output);
  const Finished nothing = evodevo({});
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_EQ(nothing.output, page.output);
}

TEST(Help, EveryCommandExplainsItself) {
  for (const Command& command : commands()) {
    const Finished page = evodevo({command.name, "--help"});
    EXPECT_EQ(page.exit_code, 0);
    EXPECT_THAT(page.output, HasSubstr("usage: evodevo " + call_of(command)));
    for (const std::string& option : names_of_options(command)) EXPECT_THAT(page.output, HasSubstr("  " + option));
    ASSERT_FALSE(command.examples.empty()) << command.name;
    for (const std::string& example : command.examples) EXPECT_THAT(page.output, HasSubstr("  evodevo " + example));
    EXPECT_EQ(evodevo({"help", command.name}).output, page.output);
  }
}

TEST(Help, ExamplesAreCommandLines) {
  for (const Command& command : commands())
    for (const std::string& example : command.examples) {
      std::istringstream line(example.substr(0, example.find_first_of(">|")));
      std::vector<std::string> words;
      for (std::string word; line >> word;) words.push_back(word);
      ASSERT_EQ(words.front(), command.name);
      EXPECT_NO_THROW(parse(command, {words.begin() + 1, words.end()})) << example;
    }
}

TEST(Help, TopicsArePrintedAndOthersRefused) {
  for (const Topic& topic : topics()) {
    const Finished page = evodevo({"help", topic.name});
    EXPECT_EQ(page.exit_code, 0);
    for (const Definition& definition : topic.definitions) EXPECT_THAT(page.output, HasSubstr(definition.term));
    EXPECT_THAT(page.output, HasSubstr(topic.example));
    std::istringstream lines(page.output);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
  }
  const Finished refused = evodevo({"help", "archiv"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, AllOf(HasSubstr("help archiv: "), HasSubstr("did you mean \"archive\"?")));
}

TEST(Help, TheExperimentOfTheTopicRunsAndItsTablesExist) {
  const Topic& topic = topic_named("experiment");
  const testing::Scratch scratch;
  const std::string file = scratch.write("topic.toml", topic.example);
  const Finished checked = evodevo({"check", file});
  EXPECT_EQ(checked.exit_code, 0) << checked.output;
  for (const Definition& definition : topic.definitions) {
    const std::string table = definition.term.substr(0, definition.term.find(','));
    if (table.find("NAME") != table.npos || topic.example.find(table) != std::string::npos) continue;
    const std::string key = table.substr(table.find_first_not_of('['), table.find(']') - table.find_first_not_of('['));
    const bool is_list = table.starts_with("[[");
    const std::string name = is_list ? "\nname = \"two-point\"\n" : "\n";
    const Finished finished = evodevo({"check", scratch.write("with.toml", topic.example + (is_list ? "[[" : "[") +
                                                                               key + (is_list ? "]]" : "]") + name)});
    EXPECT_EQ(finished.exit_code, 0) << table << ": " << finished.output;
  }
}

TEST(Help, TheTopicOfVerificationNamesTheTrials) {
  const testing::Scratch scratch;
  const std::string file = scratch.write("small.toml", small_experiment), folder = (scratch / "run").string();
  ASSERT_EQ(evodevo({"run", file, "--out", folder}).exit_code, 0);
  const std::string page = evodevo({"help", "verification"}).output;
  const auto verified = nlohmann::json::parse(evodevo({"verify", folder, "--best", "1", "--json"}).output);
  for (const auto& trial : verified[0].at("trials")) EXPECT_THAT(page, HasSubstr(trial.at("trial").get<std::string>()));
}

/// Returns the lines of a shell's output; expects that the shell has succeeded.
std::vector<std::string> lines_of(const Finished& finished) {
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  std::istringstream stream(finished.output);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);)
    if (!line.empty()) lines.push_back(line);
  return lines;
}

class Completion : public ::testing::Test {
 protected:
  Completion() {
    for (const char* shell : {"bash", "zsh", "fish"}) {
      const Finished printed = evodevo({"completion", shell});
      EXPECT_EQ(printed.exit_code, 0);
      scratch_.write(std::string("script.") + shell, printed.output);
    }
    fs::create_directory(scratch_ / "folder");
    scratch_.write("file.toml", "");
  }

  /// Returns the completions that bash offers for the last of these words.
  std::vector<std::string> offered(const std::vector<std::string>& words) const {
    std::vector<std::string> line = {
        "bash",
        "-c",
        "cd \"$1\" && source script.bash && shift && COMP_WORDS=(\"$@\") && "
        "COMP_CWORD=$(($# - 1)) && { _evodevo \"$1\"; printf '%s\\n' \"${COMPREPLY[@]}\"; }",
        "bash",
        (scratch_ / "").string(),
        EVODEVO_PROGRAM};
    line.insert(line.end(), words.begin(), words.end());
    return lines_of(testing::run(line));
  }

  std::string script(const std::string& shell) const { return (scratch_ / ("script." + shell)).string(); }

  testing::Scratch scratch_;
};

TEST_F(Completion, BashKnowsCommandsAndOptions) {
  EXPECT_THAT(lines_of(testing::run({"bash", "-c", "source \"$0\" && complete -p evodevo", script("bash")})),
              ElementsAre("complete -F _evodevo evodevo"));
  const auto all = offered({""});
  for (const Command& command : commands()) {
    EXPECT_THAT(all, Contains(command.name));
    EXPECT_THAT(offered({command.name, "--"}), ::testing::UnorderedElementsAreArray(names_of_options(command)));
  }
  EXPECT_THAT(offered({"sim"}), ElementsAre("simulate"));
}

TEST_F(Completion, BashKnowsValuesFoldersAndFiles) {
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
  EXPECT_THAT(lines_of(testing::run({"zsh", "-n", script("zsh")})), IsEmpty());
  EXPECT_THAT(lines_of(testing::run({"zsh", "-fc",
                                     "autoload -Uz compinit && compinit -D && source \"$0\" && print $_comps[evodevo]",
                                     script("zsh")})),
              ElementsAre("_evodevo"));
}

TEST_F(Completion, FishCompletes) {
  if (!is_installed("fish")) GTEST_SKIP() << "there is no fish";
  const auto fish_offers = [&](const std::string& line) {
    auto lines =
        lines_of(testing::run({"sh", "-c",
                               "cd \"$0\" && export HOME=$0 PATH=\"$1:$PATH\" && "
                               "fish -c 'source script.fish; complete -C \"'\"$2\"'\"'",
                               (scratch_ / "").string(), fs::path(EVODEVO_PROGRAM).parent_path().string(), line}));
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
  const Finished refused = evodevo({"completion", "csh"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, AllOf(HasSubstr("completion csh: "), HasSubstr("bash")));
}

TEST(Manual, HasEveryCommandOptionExampleAndTopic) {
  const Finished page = evodevo({"man"});
  ASSERT_EQ(page.exit_code, 0);
  const auto escaped = [](std::string text) {
    for (std::size_t at = 0; (at = text.find('-', at)) != text.npos; at += 2) text.replace(at, 1, "\\-");
    return text;
  };
  for (const Command& command : commands()) {
    EXPECT_THAT(page.output, HasSubstr(".SS evodevo " + escaped(call_of(command))));
    for (const std::string& option : names_of_options(command))
      EXPECT_THAT(page.output, HasSubstr("\\fB" + escaped(option) + "\\fR"));
  }
  for (const char* part : {".SH ENVIRONMENT", "EVODEVO_PLUGIN_PATH", ".SH EXIT CODES", ".SH EXPERIMENT"})
    EXPECT_THAT(page.output, HasSubstr(part));
}

TEST(Manual, IsGoodRoff) {
  if (!is_installed("groff")) GTEST_SKIP() << "there is no groff";
  const testing::Scratch scratch;
  const std::string file = scratch.write("evodevo.1", evodevo({"man"}).output);
  EXPECT_THAT(lines_of(testing::run({"groff", "-man", "-ww", "-z", "-Tascii", file})), IsEmpty());
  const std::string shown = testing::run({"groff", "-man", "-Tascii", "-P-cbou", file}).output;
  EXPECT_THAT(shown, AllOf(HasSubstr("--allow-other-versions"), HasSubstr("\n       [experiment]\n")));
}

/// Runs the small experiment with more options.
class Verbosity : public ::testing::Test {
 protected:
  std::vector<std::string> run(std::vector<std::string> options) {
    options.insert(options.begin(), {"run", scratch_.write("small.toml", small_experiment), "--out", folder_});
    return lines_of(evodevo(std::move(options)));
  }

  testing::Scratch scratch_;
  std::string folder_ = (scratch_ / "run").string();
};

TEST_F(Verbosity, QuietPrintsResultsAlone) {
  const auto lines = run({"--quiet"});
  ASSERT_EQ(lines.size(), 2u + 11u) << "the best, its verification and its trials";
  EXPECT_THAT(lines[0], AllOf(HasSubstr("best: individual "), HasSubstr(folder_)));
  EXPECT_THAT(lines[1], ::testing::StartsWith("individual "));
}

TEST_F(Verbosity, VerboseSaysWhatTakesHowLong) {
  const auto lines = run({"--verbose"});
  const auto step = [](const std::string& what) {
    return Contains(::testing::ContainsRegex("^evodevo: .*" + what + ".* took [0-9.e-]+ s$"));
  };
  for (const char* what : {"loading its operators", "simulator", "verifying"}) EXPECT_THAT(lines, step(what));
  const Finished shown =
      testing::run({"sh", "-c", "exec \"$0\" operators --json --verbose 2>/dev/null", EVODEVO_PROGRAM});
  EXPECT_TRUE(nlohmann::json::accept(shown.output)) << "notices do not mix with results";
}

TEST_F(Verbosity, ItIsOneOrTheOther) {
  const Finished refused = evodevo({"operators", "--quiet", "--verbose"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, AllOf(HasSubstr("--quiet"), HasSubstr("--verbose"), HasSubstr("give one")));
}

TEST(SlowSteps, AreToldToTheListenerFromBeginToEnd) {
  { const SlowStep unheard("nobody listens"); }
  std::vector<std::string> told;
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
  const testing::Finished finished = testing::run({EVODEVO_PROGRAM, "--version"});
  EXPECT_EQ(finished.exit_code, 0);
  EXPECT_THAT(finished.output, testing::at_place("evodevo " EVODEVO_VERSION "\nbuild: ", "\nfeatures: CUDA ", ", MPI ",
                                                 ", viewer ", "\ndevices: cpu, ", "core"));
#ifndef EVODEVO_CUDA
  EXPECT_THAT(finished.output, testing::naming("CUDA no", "no GPU: ", "without CUDA"));
#endif
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
