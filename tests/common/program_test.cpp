// Tests of code that the measuring programs share.
#include "common/program.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "common/agreement.hpp"
#include "common/table.hpp"

namespace evodevo::tools::EVODEVO_FILE {
namespace {

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

TEST(Program, RunsWithItsArgumentsOrPrintsItsHelpOrSaysWhatFailed) {
  CommandLine seen;
  EXPECT_EQ(outcome({"a", "--b"}, [&](const CommandLine& line) { seen = line; }).status, 0);
  EXPECT_EQ(seen, (CommandLine{"a", "--b"}));
  const Outcome help = outcome({"a", "--help"}, [](const CommandLine&) { throw std::logic_error("ran"); });
  EXPECT_EQ(help.status, 0);
  EXPECT_EQ(help.output, program.help);
  const Outcome failed = outcome({}, [](const CommandLine&) { throw std::invalid_argument("no such study"); });
  EXPECT_EQ(failed.status, 2);
  EXPECT_EQ(failed.errors, "some: no such study\n");
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

TEST(Table, IsCsvWithAHeader) {
  Table table("results", {"method", "dt (s)"});
  table.add({"rk4", 0.00025});
  table.add({"one, \"quoted\"", 1e-12});
  table.add({"", std::numeric_limits<double>::quiet_NaN()});
  EXPECT_EQ(table.csv(), "method,dt (s)\nrk4,0.00025\n\"one, \"\"quoted\"\"\",1e-12\n,\n");
  EXPECT_EQ(table.number(0, "dt (s)"), 0.00025);
  EXPECT_EQ(table.text(0, "method"), "rk4");
}

TEST(Table, RefusesWhatDoesNotFitItsColumnsAndPlacesWhereItCannotBe) {
  Table table("results", {"method", "dt (s)"});
  EXPECT_THROW(table.add({"rk4"}), std::logic_error);
  table.add({"rk4", 1.0});
  EXPECT_THROW(table.number(0, "dt"), std::logic_error);
  EXPECT_THROW(write(table, "/nowhere/at/all"), std::runtime_error);
}

TEST(ShareFound, IsFromOneForTheTruthToZeroForItsOpposite) {
  const auto share = [](const std::vector<double>& estimate, std::size_t count) {
    return share_found(std::vector<double>{5, 1, 4, 2, 3, 0}, estimate, count);
  };
  EXPECT_EQ(share({5, 1, 4, 2, 3, 0}, 3), 1);
  EXPECT_EQ(share({50, 11, 40, 12, 30, -7}, 3), 1) << "it grows with the truth";
  EXPECT_EQ(share({0, 4, 1, 3, 2, 5}, 3), 0);
  EXPECT_DOUBLE_EQ(share({1, 1, 1, 1, 1, 1}, 2), 2.0 / 6) << "chance, where the estimate knows nothing";
  // the estimate finds 5; its values for 4, 3, 2 and 0 are equal, so these four compete for two places
  EXPECT_DOUBLE_EQ(share({9, 0, 1, 1, 1, 1}, 3), (1 + 0.5 + 0.5) / 3);
}

}  // namespace
}  // namespace evodevo::tools::EVODEVO_FILE
