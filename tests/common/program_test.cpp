// Tests of code that the measuring programs share.
#include "common/program.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace evodevo::tools::EVODEVO_FILE {
namespace {

using ::testing::HasSubstr;

constexpr Program program{"some", "the page\n"};

struct Outcome {
  int status;
  std::string output, errors;
};

Outcome outcome(std::vector<const char*> arguments, const std::function<void(const CommandLine&)>& run) {
  arguments.insert(arguments.begin(), "evodevo-some");
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int status = run_program(program, static_cast<int>(arguments.size()), arguments.data(), run);
  return {status, testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
}

TEST(Program, RunsWithItsArguments) {
  CommandLine seen;
  const Outcome done = outcome({"a", "--b"}, [&](const CommandLine& line) { seen = line; });
  EXPECT_EQ(done.status, 0);
  EXPECT_EQ(seen, (CommandLine{"a", "--b"}));
}

TEST(Program, PrintsItsHelpAndRunsNothing) {
  const Outcome done = outcome({"a", "--help"}, [](const CommandLine&) { throw std::logic_error("ran"); });
  EXPECT_EQ(done.status, 0);
  EXPECT_EQ(done.output, program.help);
}

TEST(Program, SaysWhatFailed) {
  const Outcome done = outcome({}, [](const CommandLine&) { throw std::invalid_argument("no such study"); });
  EXPECT_EQ(done.status, 2);
  EXPECT_EQ(done.errors, "some: no such study\n");
}

TEST(Program, NamesTheCommandThatRepeatsACall) {
  EXPECT_EQ(command_of(program, {"charts", "--json", "--runs=3"}, {"--json"}), "tools/some charts --runs=3");
}

TEST(Program, TakesItsFolderFirst) {
  EXPECT_NO_THROW(require_folder(program, {"charts"}));
  for (const CommandLine& line :
       {CommandLine{}, CommandLine{""}, CommandLine{"--quick", "charts"}, CommandLine{"a.toml"}})
    EXPECT_THROW(require_folder(program, line), std::invalid_argument);
}

TEST(Program, ReadsOptionsAndRefusesOthers) {
  namespace po = boost::program_options;
  int runs = 0;
  po::options_description options;
  options.add_options()("runs", po::value(&runs)->default_value(5));
  read_options({}, options);
  EXPECT_EQ(runs, 5);
  read_options({"--runs", "3"}, options);
  EXPECT_EQ(runs, 3);
  EXPECT_THROW(read_options({"--run-time", "3"}, options), po::error);
}

}  // namespace
}  // namespace evodevo::tools::EVODEVO_FILE
