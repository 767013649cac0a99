// Commands in unusual surroundings: closed streams, limits of the system, no home folder, pipes instead of files, and
// hostile arguments.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/text.hpp"
#include "support/experiments.hpp"
#include "support/process.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using testing::Finished;
using ::testing::HasSubstr;
using ::testing::Not;

class Surroundings : public ::testing::Test {
 protected:
  testing::Scratch scratch_;
  std::string file_ = scratch_.write("small (ü).toml", testing::small_experiment);
  std::string folder_ = (scratch_ / "run").string();

  /// Runs `line` in bash, with the variables $evodevo, $file, $folder and $scratch.
  Finished in_shell(const std::string& line) const {
    return testing::run({"env", std::string("evodevo=") + EVODEVO_PROGRAM, "file=" + file_, "folder=" + folder_,
                         "scratch=" + (scratch_ / "").string(), "bash", "-c", line});
  }
  static Finished evodevo(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), EVODEVO_PROGRAM);
    return testing::run(arguments);
  }
};

TEST_F(Surroundings, ClosedStreamsAreNoFault) {
  for (const char* closed : {"<&-", "2>&-", "<&- 2>&-"}) {
    const Finished finished = in_shell("\"$evodevo\" check \"$file\" " + std::string(closed));
    EXPECT_EQ(finished.exit_code, 0) << closed;
    EXPECT_THAT(finished.output, ::testing::EndsWith(file_ + ": ok\n")) << closed;
  }
  for (const char* closed : {">&-", "<&- >&-"})
    EXPECT_THAT(in_shell("\"$evodevo\" check \"$file\" " + std::string(closed)).output, Not(HasSubstr("crash")));
  // no file of the run may be opened under the descriptor of a closed stream, or messages would be written into it
  const Finished run = in_shell("\"$evodevo\" run \"$file\" --out \"$folder\" <&- 2>&-");
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_EQ(in_shell("\"$evodevo\" show \"$folder\" <&- >/dev/null 2>&-").exit_code, 0);
  const Finished operators = in_shell("\"$evodevo\" operators --failed <&- 2>&-");
  EXPECT_EQ(operators.output, "") << "none of its own libraries";
}

TEST_F(Surroundings, OutputToAClosedStreamGoesNowhereElse) {
  in_shell("\"$evodevo\" run \"$file\" --out \"$folder\" <&- >&- 2>&-");
  for (const auto& entry : fs::recursive_directory_iterator(scratch_ / "")) {
    if (!entry.is_regular_file() || entry.path() == file_) continue;
    std::ifstream stream(entry.path(), std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    EXPECT_THAT(text, Not(HasSubstr("evaluations/s"))) << entry.path();
  }
}

TEST_F(Surroundings, MoreThreadsThanTheSystemGrantsAreFewer) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer needs more address space than the limit leaves";
#endif
  const Finished finished = in_shell(
      "ulimit -v 4000000; timeout 100 \"$evodevo\" run \"$file\" --out \"$folder\" --device cpu --threads 4096");
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  const std::string warning = "warning: the system does not grant 4096 threads";
  const auto at = finished.output.find(warning);
  ASSERT_NE(at, std::string::npos) << finished.output;
  EXPECT_THAT(finished.output, HasSubstr("ulimit"));
  EXPECT_EQ(finished.output.find("warning:", at + 1), std::string::npos) << "once";
}

TEST_F(Surroundings, NothingIsWrittenWithoutAHome) {
  const Finished finished = in_shell(
      "mkdir \"$scratch/here\" && cd \"$scratch/here\" && env -u HOME -u XDG_CACHE_HOME \"$evodevo\" run \"$file\" "
      "--out \"$folder\" && env HOME=. XDG_CACHE_HOME=cache \"$evodevo\" show \"$folder\"");
  EXPECT_EQ(finished.exit_code, 0) << finished.output;
  EXPECT_TRUE(fs::is_empty(scratch_ / "here"));
}

TEST_F(Surroundings, AnExperimentMayComeThroughAPipeOfTheShell) {
  EXPECT_EQ(in_shell("\"$evodevo\" check <(cat \"$file\")").exit_code, 0);
  EXPECT_EQ(in_shell("cat \"$file\" | \"$evodevo\" check /dev/stdin").exit_code, 0);
  EXPECT_EQ(in_shell("\"$evodevo\" check /dev/stdin <&-").exit_code, 2);
}

TEST_F(Surroundings, HostileArgumentsAreRefusedInOneCleanLine) {
  const std::string odd = "\x1b[31m\n\xff", long_text(100'000, 'a');
  const std::string zero = "/dev/zero", folder = (scratch_ / "").string();
  const std::vector<std::vector<std::string>> commands = {{odd},
                                                          {long_text},
                                                          {"check", odd},
                                                          {"check", zero},
                                                          {"check", folder},
                                                          {"check", long_text},
                                                          {"check", file_, odd},
                                                          {"check", file_, "--" + odd},
                                                          {"check", file_, "--set", odd},
                                                          {"check", file_, "--set", "experiment.seed=" + odd},
                                                          {"check", file_, "--set", odd + "=1"},
                                                          {"check", file_, "--set", "experiment.seed=" + long_text},
                                                          {"check", file_, "--plugin-path", odd},
                                                          {"check", file_, "--seed", odd},
                                                          {"check", file_, "--threads", "1e9"},
                                                          {"check", file_, "--threads", ""},
                                                          {"simulate", zero, file_},
                                                          {"simulate", folder, file_},
                                                          {"simulate", odd, file_},
                                                          {"simulate", file_, file_, "--duration", "nan"},
                                                          {"simulate", file_, file_, "--duration", odd},
                                                          {"show", odd},
                                                          {"show", file_},
                                                          {"show", long_text},
                                                          {"show", zero},
                                                          {"resume", long_text},
                                                          {"verify", long_text},
                                                          {"life", odd, "--individual", "99999999999999999999"},
                                                          {"body", odd, "--individual", odd},
                                                          {"describe", odd},
                                                          {"describe", long_text},
                                                          {"operators", "--kind", odd},
                                                          {"new", odd, "x"},
                                                          {"new", "devo", odd},
                                                          {"new", "devo", long_text},
                                                          {"new", "devo", ".."},
                                                          {"new", long_text, long_text},
                                                          {"new", "devo", "x", odd},
                                                          {"new", "devo", "x", "devo", odd},
                                                          {"conform", odd},
                                                          {"conform", folder},
                                                          {"conform", zero},
                                                          {"conform", long_text},
                                                          {"conform", file_, "--seed", "-1"},
                                                          {"environments", odd},
                                                          {"environments", zero},
                                                          {"gallery", file_, "--count", "-1"},
                                                          {"gallery", file_, "--out", odd}};
  for (const std::vector<std::string>& command : commands) {
    const Finished finished = evodevo(command);
    std::string title;
    for (const std::string& argument : command) title += ' ' + printable(argument, 60);
    SCOPED_TRACE(title);
    EXPECT_EQ(finished.exit_code, 2) << finished.output;
    ASSERT_TRUE(finished.output.starts_with("evodevo: ")) << finished.output;
    EXPECT_TRUE(finished.output.ends_with('\n'));
    const std::string line = finished.output.substr(0, finished.output.size() - 1);
    EXPECT_EQ(line, printable(line, 5000));
  }
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
