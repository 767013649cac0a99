// Commands whose output goes to a full device, to a pipe that nobody reads, or into their own input file.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <iterator>

#include "evolution/archive/archive.hpp"
#include "support/experiments.hpp"
#include "support/process.hpp"
#include "support/scratch.hpp"

extern char** environ;

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using testing::Finished;
using ::testing::HasSubstr;

/// A folder with a finished run, a body of that run, and stand-ins for the page of the viewer and for Node.js; the
/// latter writes a file instead of a film.
class Workplace {
 public:
  Workplace() {
    const fs::path program = EVODEVO_PROGRAM, build = program.parent_path().parent_path();
    for (const char* folder : {"bin", "share/evodevo/viewer", "tools"}) fs::create_directories(scratch_ / folder);
    fs::copy_file(program, scratch_ / "bin" / "evodevo");
    fs::create_symlink(build / "lib", scratch_ / "lib");
    fs::create_symlink(build / "share/evodevo/template", scratch_ / "share/evodevo/template");
    scratch_.write("share/evodevo/viewer/page.html", "<script>EVODEVO_DATA</script>");
    const std::string node = scratch_.write("tools/node", "#!/bin/sh\nprintf film >\"$3\"\n");
    fs::permissions(node, fs::perms::owner_all);
    experiment = scratch_.write("small.toml", testing::small_experiment);
    run = (scratch_ / "run").string();
    if (shell("evodevo run small.toml --out run").exit_code != 0) throw std::runtime_error("the run failed");
    if (shell("evodevo body run >body.json").exit_code != 0) throw std::runtime_error("there is no body");
    for (const char* link : {"full.html", "full.mp4", "full.png", "full.csv"})
      fs::create_symlink("/dev/full", scratch_ / link);
  }

  /// Runs a shell command in the folder.
  Finished shell(const std::string& line) const {
    const std::string here = scratch_ / "";
    return testing::run({"sh", "-c", "cd \"$0\" && PATH=\"$0/bin:$0/tools:$PATH\" && export PATH && " + line, here});
  }
  fs::path operator/(const std::string& name) const { return scratch_ / name; }

  std::string experiment, run;

 private:
  testing::Scratch scratch_;
};

/// Returns the folder that all tests of this process share; the first call creates it.
const Workplace& workplace() {
  static const Workplace workplace;
  return workplace;
}

std::string content(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string test_name(const ::testing::TestParamInfo<const char*>& info) {
  std::string name = std::to_string(info.index) + "_";
  for (const char c : std::string_view(info.param))
    if (std::isalpha(static_cast<unsigned char>(c))) name += c;
  return name;
}

class Printed : public ::testing::TestWithParam<const char*> {};

TEST_P(Printed, WhatIsLostIsSaid) {
  const Finished finished = workplace().shell(std::string("exec evodevo ") + GetParam() + " >/dev/full");
  EXPECT_EQ(finished.exit_code, 1) << finished.output;
  EXPECT_THAT(finished.output, HasSubstr("evodevo: standard output: cannot be written: No space left on device\n"));
}

INSTANTIATE_TEST_SUITE_P(Commands, Printed,
                         ::testing::Values("--help", "--version", "run small.toml --out \"$(mktemp -d)\"", "run --help",
                                           "resume --help", "show run", "show run --json", "verify run --best 1",
                                           "verify run --best 1 --json", "body run", "body run --matured", "life run",
                                           "life run --json", "simulate body.json small.toml --duration 0.01",
                                           "environments small.toml --starts 2",
                                           "environments small.toml --starts 2 --json", "check small.toml", "operators",
                                           "operators --json", "operators --markdown", "describe spring-turnover",
                                           "describe spring-turnover --markdown", "new devo own.op$$",
                                           "conform lib/evodevo/elitist.evodevo.so",
                                           "conform lib/evodevo/elitist.evodevo.so --json",
                                           "report run --out page.html", "film run --out film.mp4",
                                           "film run --out film.png", "gallery small.toml --count 2 --out gallery.html",
                                           "gallery small.toml --count 2 --out gallery.png"),
                         test_name);

class Filed : public ::testing::TestWithParam<const char*> {};

TEST_P(Filed, WhatIsLostIsSaid) {
  const Finished finished = workplace().shell(std::string("exec evodevo ") + GetParam());
  EXPECT_EQ(finished.exit_code, 1) << finished.output;
  EXPECT_THAT(finished.output, AllOf(HasSubstr("full"), HasSubstr(": cannot be written: No space left on device\n")));
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

INSTANTIATE_TEST_SUITE_P(Commands, Filed,
                         ::testing::Values("simulate body.json small.toml --duration 0.01 --trajectory /dev/full",
                                           "simulate body.json small.toml --duration 5 --trajectory full.csv",
                                           "report run --out /dev/full", "report run --out full.html",
                                           "film run --out full.mp4", "film run --out full.png --at 0",
                                           "gallery small.toml --count 2 --out full.html",
                                           "gallery small.toml --count 2 --out full.png"),
                         test_name);

TEST(Output, ARunIsWholeEvenIfNobodyCouldReadHowItWent) {
  const Finished finished = workplace().shell("exec evodevo run small.toml --out unheard >/dev/full");
  EXPECT_EQ(finished.exit_code, 1);
  EXPECT_EQ(Archive::read(workplace() / "unheard").generations().back().evaluations, 24);
}

/// Runs a shell command whose standard output is a pipe that nobody reads. Returns the exit code, or 128 + the number
/// of the signal that ended it.
int exit_without_reader(const std::string& line, const std::string& errors) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  close(ends[0]);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  std::string shell = "/bin/sh", option = "-c", script = line;
  char* const arguments[] = {shell.data(), option.data(), script.data(), nullptr};
  pid_t child = 0;
  const int failed = posix_spawn(&child, shell.c_str(), &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (failed != 0) throw std::runtime_error("no shell");
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

TEST(Output, AReaderThatHasGoneEndsACommandQuietly) {
  const testing::Scratch scratch;
  const std::string errors = (scratch / "errors").string();
  for (const std::string before : {"", "trap '' PIPE; "}) {  // also if the caller ignores SIGPIPE
    const int code = exit_without_reader(before + "exec '" EVODEVO_PROGRAM "' operators --markdown", errors);
    EXPECT_EQ(code, 128 + SIGPIPE) << before;
    EXPECT_EQ(content(errors), "") << before;
  }
}

class Overwriting : public ::testing::TestWithParam<const char*> {};

TEST_P(Overwriting, WhatIsReadIsRefused) {
  const Workplace& at = workplace();
  for (const auto& [link, file] : {std::pair{"run.html", "run/run.sqlite"}, std::pair{"run.mp4", "run/run.sqlite"}})
    if (!fs::exists(at / link)) fs::create_symlink(at / file, at / link);
  const std::string record = content(at / "run/run.sqlite");
  const Finished finished = at.shell(std::string("exec evodevo ") + GetParam());
  EXPECT_EQ(finished.exit_code, 2) << finished.output;
  EXPECT_THAT(finished.output, AllOf(HasSubstr("run.sqlite"), ::testing::ContainsRegex("another file|elsewhere")))
      << finished.output;
  EXPECT_TRUE(record == content(at / "run/run.sqlite"));
}

INSTANTIATE_TEST_SUITE_P(Commands, Overwriting,
                         ::testing::Values("report run --out run/run.sqlite", "report run --out ./run/../run.html",
                                           "film run --out run.mp4", "show run >>run/run.sqlite",
                                           "report run --out page.html >>run/run.sqlite"),
                         test_name);

TEST(Output, AGalleryNeverTakesThePlaceOfItsExperiment) {
  const Workplace& at = workplace();
  fs::create_hard_link(at / "small.toml", at / "hard.html");
  const Finished finished = at.shell("exec evodevo gallery small.toml --out hard.html");
  EXPECT_EQ(finished.exit_code, 2) << finished.output;
  EXPECT_THAT(finished.output, AllOf(HasSubstr("--out hard.html"), HasSubstr("small.toml")));
  EXPECT_EQ(content(at / "small.toml"), testing::small_experiment);
}

TEST(Output, AFileThatCannotGrowStaysWhatItWas) {
  const Workplace& at = workplace();
  ASSERT_EQ(at.shell("evodevo simulate body.json small.toml --duration 0.01 --trajectory kept.csv").exit_code, 0);
  const std::string before = content(at / "kept.csv");
  for (const std::string command : {"simulate body.json small.toml --duration 5 --trajectory kept.csv",
                                    "simulate body.json small.toml --duration 5 --trajectory fresh.csv"}) {
    const Finished finished = at.shell("trap '' XFSZ; ulimit -f 8; exec evodevo " + command);
    EXPECT_EQ(finished.exit_code, 1) << finished.output;
    EXPECT_THAT(finished.output, AllOf(HasSubstr(".csv: cannot be written: File too large\n")));
  }
  EXPECT_EQ(content(at / "kept.csv"), before);
  EXPECT_FALSE(fs::exists(at / "fresh.csv"));
  for (const auto& entry : fs::directory_iterator(at / ""))
    EXPECT_THAT(entry.path().string(), ::testing::Not(HasSubstr("unfinished")));
}

TEST(Output, HalfAProjectIsNone) {
  const Workplace& at = workplace();
  const Finished finished = at.shell("trap '' XFSZ; ulimit -f 0; exec evodevo new devo own.half");
  EXPECT_EQ(finished.exit_code, 1) << finished.output;
  EXPECT_THAT(finished.output, AllOf(HasSubstr("own.half/"), HasSubstr("File too large")));
  EXPECT_FALSE(fs::exists(at / "own.half"));
}

TEST(Output, AGalleryBlamesTheEncodingForBodiesThatAreNone) {
  const Workplace& at = workplace();
  const std::string library = EVODEVO_FAULTY_PLUGINS "/wrong_decoding/plugin.evodevo.so";
  const Finished finished = at.shell(
      "sed 's/^name = \"voxel\"/name = \"wrong\"/;/^size/d;/^edge/d' small.toml >wrong.toml && "
      "exec evodevo gallery wrong.toml --plugin-path '" +
      library + "'");
  EXPECT_EQ(finished.exit_code, 1) << finished.output;
  EXPECT_THAT(finished.output,
              AllOf(HasSubstr("encoding operator \"wrong\""), HasSubstr(library), HasSubstr("spring 0 ")));
}

TEST(Output, PagesAndFilmsArriveWhole) {
  const Workplace& at = workplace();
  EXPECT_EQ(at.shell("exec evodevo report run --out own.html").output, "own.html\n");
  EXPECT_THAT(content(at / "own.html"), HasSubstr("\"kind\":\"report\""));
  EXPECT_EQ(at.shell("exec evodevo film run --out own.mp4").output, "own.mp4\n");
  EXPECT_EQ(content(at / "own.mp4"), "film");
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
