// Where output goes, and what commands do in unusual surroundings: terminals, logs, full devices, pipes that nobody
// reads, input files, closed streams, limits of the system, no home folder, and hostile arguments.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>

#include "archive/archive.hpp"
#include "base/text.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/program.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using namespace testing;
using ::testing::HasSubstr;
using ::testing::Not;

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
    scratch_.write("small.toml", small_experiment);
    shell("evodevo run small.toml --out run", 0);
    shell("evodevo body run >body.json", 0);
    for (const char* link : {"full.html", "full.mp4", "full.png", "full.csv"})
      fs::create_symlink("/dev/full", scratch_ / link);
  }

  /// Runs a shell command in the folder, expects the exit code, and returns the output.
  std::string shell(const std::string& line, int exit_code) const {
    const std::string here = scratch_ / "", set = "cd \"$0\" && PATH=\"$0/bin:$0/tools:$PATH\" && export PATH && ";
    return output_of({"sh", "-c", set + line, here}, exit_code);
  }
  fs::path operator/(const std::string& name) const { return scratch_ / name; }

 private:
  Scratch scratch_;
};

std::string content(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(Output, WhatIsLostIsSaidAndARunIsWholeNevertheless) {
  const Workplace at;
  const auto expect_lost = [&](const std::string& place, const std::string& redirection, auto... commands) {
    for (const std::string command : {commands...}) {
      EXPECT_THAT(at.shell("exec evodevo " + command + redirection, 1),
                  naming(place, ": cannot be written: No space left on device\n"));
      EXPECT_TRUE(fs::is_character_file("/dev/full"));
    }
  };
  expect_lost("evodevo: standard output: cannot", " >/dev/full", "--help", "--version", "run small.toml --out unheard",
              "run --help", "resume --help", "show run", "show run --json", "verify run --best 1",
              "verify run --best 1 --json", "body run", "body run --matured", "life run", "life run --json",
              "simulate body.json small.toml --duration 0.01", "environments small.toml --starts 2",
              "environments small.toml --starts 2 --json", "check small.toml", "operators", "operators --json",
              "operators --markdown", "describe spring-turnover", "describe spring-turnover --markdown",
              "new devo own.op$$", "conform lib/evodevo/elitist.evodevo.so",
              "conform lib/evodevo/elitist.evodevo.so --json", "report run --out page.html", "film run --out film.mp4",
              "film run --out film.png", "gallery small.toml --count 2 --out gallery.html",
              "gallery small.toml --count 2 --out gallery.png");
  EXPECT_EQ(Archive::read(at / "unheard").generations().back().evaluations, 24);
  expect_lost("full", "", "simulate body.json small.toml --duration 0.01 --trajectory /dev/full",
              "simulate body.json small.toml --duration 5 --trajectory full.csv", "report run --out /dev/full",
              "report run --out full.html", "film run --out full.mp4", "film run --out full.png --at 0",
              "gallery small.toml --count 2 --out full.html", "gallery small.toml --count 2 --out full.png");
}

TEST(Output, AReaderThatHasGoneEndsACommandQuietly) {
  for (const std::string before : {"", "trap '' PIPE; "}) {  // also if the caller ignores SIGPIPE
    const std::string call = "exec '" EVODEVO_PROGRAM "' operators --markdown >&3";
    const Finished finished = testing::run({"bash", "-c", "exec 3> >(:); wait $!; " + before + call});
    EXPECT_EQ(finished.exit_code, 128 + SIGPIPE) << before;
    EXPECT_EQ(finished.output, "") << before;
  }
}

TEST(Output, WhatIsReadIsNeverOverwritten) {
  const Workplace at;
  for (const char* link : {"run.html", "run.mp4"}) fs::create_symlink(at / "run/run.sqlite", at / link);
  const std::string record = content(at / "run/run.sqlite");
  for (const std::string command :
       {"report run --out run/run.sqlite", "report run --out ./run/../run.html", "film run --out run.mp4",
        "show run >>run/run.sqlite", "report run --out page.html >>run/run.sqlite"}) {
    EXPECT_THAT(at.shell("exec evodevo " + command, 2),
                ::testing::AllOf(HasSubstr("run.sqlite"), ::testing::ContainsRegex("another file|elsewhere")));
    EXPECT_TRUE(record == content(at / "run/run.sqlite"));
  }
  fs::create_hard_link(at / "small.toml", at / "hard.html");
  EXPECT_THAT(at.shell("exec evodevo gallery small.toml --out hard.html", 2), naming("--out hard.html", "small.toml"));
  EXPECT_EQ(content(at / "small.toml"), small_experiment);
}

TEST(Output, AFileThatCannotGrowStaysWhatItWasAndHalfAProjectIsNone) {
  const Workplace at;
  at.shell("evodevo simulate body.json small.toml --duration 0.01 --trajectory kept.csv", 0);
  const std::string before = content(at / "kept.csv");
  for (const std::string command : {"simulate body.json small.toml --duration 5 --trajectory kept.csv",
                                    "simulate body.json small.toml --duration 5 --trajectory fresh.csv"}) {
    EXPECT_THAT(at.shell("trap '' XFSZ; ulimit -f 8; exec evodevo " + command, 1),
                HasSubstr(".csv: cannot be written: File too large\n"));
  }
  EXPECT_EQ(content(at / "kept.csv"), before);
  EXPECT_FALSE(fs::exists(at / "fresh.csv"));
  for (const auto& entry : fs::directory_iterator(at / ""))
    EXPECT_THAT(entry.path().string(), ::testing::Not(HasSubstr("unfinished")));
  EXPECT_THAT(at.shell("trap '' XFSZ; ulimit -f 0; exec evodevo new devo own.half", 1),
              naming("own.half/", "File too large"));
  EXPECT_FALSE(fs::exists(at / "own.half"));
}

TEST(Output, AGalleryBlamesTheEncodingForBodiesThatAreNone) {
  const Workplace at;
  const std::string library = EVODEVO_FAULTY_PLUGINS "/wrong_decoding/plugin.evodevo.so";
  const std::string command =
      "sed 's/^name = \"voxel\"/name = \"wrong\"/;/^size/d;/^edge/d' small.toml >wrong.toml && "
      "exec evodevo gallery wrong.toml --plugin-path '" +
      library + "'";
  EXPECT_THAT(at.shell(command, 1), naming("encoding operator \"wrong\"", library, "spring 0 "));
}

TEST(Output, PagesAndFilmsArriveWhole) {
  const Workplace at;
  EXPECT_EQ(at.shell("exec evodevo report run --out own.html", 0), "own.html\n");
  EXPECT_THAT(content(at / "own.html"), HasSubstr("\"kind\":\"report\""));
  EXPECT_EQ(at.shell("exec evodevo film run --out own.mp4", 0), "own.mp4\n");
  EXPECT_EQ(content(at / "own.mp4"), "film");
}

class RunOutput : public ::testing::Test {
 protected:
  Words run_words(const Words& more) const { return joined({"run", file_, "--out", folder_.string()}, more); }
  /// Runs on a terminal of so many columns.
  std::string run_on_terminal(const std::string& variables, int columns) const {
    const std::string command = "stty cols " + std::to_string(columns) + "; " + variables + " " + EVODEVO_PROGRAM +
                                " run " + file_ + " --no-report --out " + folder_.string();
    fs::remove_all(folder_);
    return output_of({"script", "-qec", command, "/dev/null"});
  }
  /// The lines that were kept up to date, without escape sequences.
  static std::vector<std::string> live_lines(const std::string& output) {
    const std::string begin = "\r\x1b[K";
    std::vector<std::string> lines;
    for (std::size_t at = output.find(begin); at != std::string::npos; at = output.find(begin, at + 1)) {
      const std::size_t first = at + begin.size();
      lines.push_back(std::regex_replace(output.substr(first, output.find_first_of("\r\n", first) - first),
                                         std::regex("\x1b\\[[0-9;]*m"), ""));
    }
    return lines;
  }

  Scratch scratch_;
  std::string file_ = scratch_.write("small.toml", small_experiment);
  fs::path folder_ = scratch_ / "run";
};

TEST_F(RunOutput, FitsTheTerminalAndHasColoursUnlessTheUserWantsNone) {
  for (const int columns : {30, 36, 57, 250}) {
    const std::string output = run_on_terminal("TERM=xterm NO_COLOR=", columns);
    EXPECT_THAT(output, HasSubstr("\x1b[1m"));
    const std::vector<std::string> lines = live_lines(output);
    ASSERT_FALSE(lines.empty());
    for (const std::string& line : lines) EXPECT_LT(line.size(), static_cast<std::size_t>(columns)) << line;
    EXPECT_THAT(lines.back(), HasSubstr("evaluations 24/24")) << "the last line is always shown";
    EXPECT_TRUE(columns < 36 || lines.back().find("best") != std::string::npos) << lines.back();
    EXPECT_EQ(lines.back().find("generation") != std::string::npos, columns > 36) << lines.back();
    EXPECT_EQ(lines.back().find("diverged") != std::string::npos, columns == 250) << lines.back();
  }
  for (const std::string none : {"TERM=xterm NO_COLOR=1", "TERM=dumb"})
    EXPECT_THAT(run_on_terminal(none, 80), Not(HasSubstr("\x1b[1m"))) << none;
}

TEST_F(RunOutput, IsLoggedForOtherPrograms) {
  const fs::path log = scratch_ / "run.log";
  const std::string output = said(run_words({"--log", log.string(), "--no-report"}));
  EXPECT_THAT(output, Not(::testing::AnyOf(HasSubstr("\x1b"), HasSubstr("report.html")))) << "it is no terminal";
  EXPECT_FALSE(fs::exists(folder_ / "report.html"));
  std::ifstream stream(log);
  std::vector<nlohmann::json> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(nlohmann::json::parse(line));
  ASSERT_EQ(lines.size(), 4u) << "one for each generation";
  EXPECT_EQ(lines.back()["evaluations"], 24);
  const auto shown = nlohmann::json::parse(said({"show", folder_.string(), "--json"}))["generations"];
  for (std::size_t i = 0; i < lines.size(); ++i)
    for (const auto& [name, value] : lines[i].items()) EXPECT_EQ(value, shown[i].at(name)) << name;
}

TEST_F(RunOutput, NeverGoesIntoAFileThatTheCommandReads) {
  EXPECT_THAT(refusal(run_words({"--log", file_})), naming("--log", file_));
  EXPECT_THAT(refusal(run_words({"--log", (folder_ / "run.log").string()})), naming("--log", "run.log"));
  EXPECT_FALSE(fs::exists(folder_)) << "a fault costs no folder";
  const Words endless{"--no-report", "--set", "experiment.evaluations=1000000", "--until", "1s"};
  output_of(program(run_words(endless)), 130);
  const std::string database = (folder_ / "run.sqlite").string();
  EXPECT_THAT(refusal({"resume", folder_.string(), "--log", database}), naming("--log", database));
  output_of(program({"resume", folder_.string(), "--no-report", "--until", "1s"}), 130);
}

TEST_F(RunOutput, EndsWithAPageOrTheCommandThatMakesIt) {
  const fs::path viewer = fs::path(EVODEVO_PROGRAM).parent_path().parent_path() / "share/evodevo/viewer/page.html";
  const std::string output = said(run_words({}));
  EXPECT_THAT(output, naming(" film " + folder_.string(), " verify " + folder_.string()));
  const fs::path page = folder_ / "report.html";
  ASSERT_EQ(fs::exists(page), fs::exists(viewer));
  if (!fs::exists(viewer)) {
    EXPECT_THAT(output, HasSubstr(" report " + folder_.string() + " --out " + page.string()));
    return;
  }
  EXPECT_THAT(output, HasSubstr("file://" + page.lexically_normal().string()));
  EXPECT_THAT(content(page), HasSubstr("\"kind\":\"report\""));
}

class Surroundings : public ::testing::Test {
 protected:
  Scratch scratch_;
  std::string file_ = scratch_.write("small (ü).toml", small_experiment);
  std::string folder_ = (scratch_ / "run").string();

  /// Runs `line` in bash, with the variables $evodevo, $file, $folder and $scratch.
  Finished in_shell(const std::string& line) const {
    return testing::run({"env", std::string("evodevo=") + EVODEVO_PROGRAM, "file=" + file_, "folder=" + folder_,
                         "scratch=" + (scratch_ / "").string(), "bash", "-c", line});
  }
};

TEST_F(Surroundings, ClosedStreamsAreNoFaultAndOutputToThemGoesNowhereElse) {
  for (const char* closed : {"<&-", "2>&-", "<&- 2>&-"}) {
    const Finished finished = in_shell("\"$evodevo\" check \"$file\" " + std::string(closed));
    EXPECT_EQ(finished.exit_code, 0) << closed;
    EXPECT_THAT(finished.output, ::testing::EndsWith(file_ + ": ok\n")) << closed;
  }
  for (const char* closed : {">&-", "<&- >&-"})
    EXPECT_THAT(in_shell("\"$evodevo\" check \"$file\" " + std::string(closed)).output, Not(HasSubstr("crash")));
  // no file of the run may be opened under the descriptor of a closed stream, or messages would be written into it
  EXPECT_EQ(in_shell("\"$evodevo\" run \"$file\" --out \"$folder\" <&- 2>&-").exit_code, 0);
  EXPECT_EQ(in_shell("\"$evodevo\" show \"$folder\" <&- >/dev/null 2>&-").exit_code, 0);
  EXPECT_EQ(in_shell("\"$evodevo\" operators --failed <&- 2>&-").output, "") << "none of its own libraries";
  in_shell("\"$evodevo\" run \"$file\" --out \"$folder-2\" <&- >&- 2>&-");
  for (const auto& entry : fs::recursive_directory_iterator(scratch_ / "")) {
    if (!entry.is_regular_file() || entry.path() == file_) continue;
    EXPECT_THAT(content(entry.path()), Not(HasSubstr("evaluations/s"))) << entry.path();
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

TEST_F(Surroundings, AnExperimentMayComeThroughAPipeOfTheShell) {
  EXPECT_EQ(in_shell("\"$evodevo\" check <(cat \"$file\")").exit_code, 0);
  EXPECT_EQ(in_shell("cat \"$file\" | \"$evodevo\" check /dev/stdin").exit_code, 0);
  EXPECT_EQ(in_shell("\"$evodevo\" check /dev/stdin <&-").exit_code, 2);
}

TEST_F(Surroundings, HostileArgumentsAreRefusedInOneCleanLine) {
  const std::string odd = "\x1b[31m\n\xff", long_text(100'000, 'a');
  const std::string zero = "/dev/zero", folder = (scratch_ / "").string();
  // clang-format off
  const std::vector<Words> commands = {
      {odd}, {long_text}, {"check", odd}, {"check", zero}, {"check", folder}, {"check", long_text},
      {"check", file_, odd}, {"check", file_, "--" + odd}, {"check", file_, "--set", odd},
      {"check", file_, "--set", "experiment.seed=" + odd}, {"check", file_, "--set", odd + "=1"},
      {"check", file_, "--set", "experiment.seed=" + long_text}, {"check", file_, "--plugin-path", odd},
      {"check", file_, "--seed", odd}, {"check", file_, "--threads", "1e9"}, {"check", file_, "--threads", ""},
      {"simulate", zero, file_}, {"simulate", folder, file_}, {"simulate", odd, file_},
      {"simulate", file_, file_, "--duration", "nan"}, {"simulate", file_, file_, "--duration", odd}, {"show", odd},
      {"show", file_}, {"show", long_text}, {"show", zero}, {"resume", long_text}, {"verify", long_text},
      {"life", odd, "--individual", "99999999999999999999"}, {"body", odd, "--individual", odd}, {"describe", odd},
      {"describe", long_text}, {"operators", "--kind", odd}, {"new", odd, "x"}, {"new", "devo", odd},
      {"new", "devo", long_text}, {"new", "devo", ".."}, {"new", long_text, long_text}, {"new", "devo", "x", odd},
      {"new", "devo", "x", "devo", odd}, {"conform", odd}, {"conform", folder}, {"conform", zero},
      {"conform", long_text}, {"conform", file_, "--seed", "-1"}, {"environments", odd}, {"environments", zero},
      {"gallery", file_, "--count", "-1"}, {"gallery", file_, "--out", odd}};
  // clang-format on
  for (const Words& command : commands) {
    const Finished finished = testing::evodevo(command);
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
