// The border between host and plugins: the libraries that are refused, and the messages about them; the context of
// operator calls, and the changes of process state that operators leave behind; and work in a child process: whatever
// happens there, the parent process continues.
#include "operators/loader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cfenv>
#include <clocale>
#include <csignal>
#include <locale>
#include <thread>
#include <vector>

#include "experiment/experiment.hpp"
#include "operators/declarations.hpp"
#include "operators/isolation.hpp"
#include "operators/operator_call.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using testing::naming;

namespace fs = std::filesystem;

/// Returns a folder of tests/plugins.
fs::path faulty(const std::string& fault) { return fs::path(EVODEVO_FAULTY_PLUGINS) / fault; }

/// Returns the only library or folder that is refused.
FailedLibrary refused(const std::vector<fs::path>& paths) {
  const Registry registry(paths);
  EXPECT_EQ(registry.failed().size(), 1u);
  return registry.failed().empty() ? FailedLibrary() : registry.failed()[0];
}

/// Returns the message with which the only library in the folder `fault` of tests/plugins is refused.
std::string refusal(const std::string& fault, std::vector<fs::path> others_first = {}) {
  others_first.push_back(faulty(fault));
  const auto [file, reason] = refused(others_first);
  EXPECT_EQ(file.parent_path().filename(), fault);
  return reason;
}

constexpr const char* rebuild = "rebuild the plugin";

TEST(Loader, ASoundLibraryIsUsedOnceHoweverManyPathsLeadToIt) {
  const Registry registry({faulty("sound"), faulty("sound") / ".", faulty("sound") / "plugin.evodevo.so"});
  EXPECT_TRUE(registry.failed().empty());
  EXPECT_EQ(registry.operators().size(), 1u);
  const AvailableOperator* nothing = registry.find("mutation", "nothing");
  ASSERT_NE(nothing, nullptr);
  EXPECT_EQ(registry.find("crossover", "nothing"), nullptr);
  EXPECT_STREQ(nothing->manifest->version, "1.0.0");
  EXPECT_NE(create<Mutation>(*nothing), nullptr);
}

TEST(Loader, LibrariesThatDoNotFit) {
  EXPECT_THAT(refusal("magic"), naming("evodevo_plugin", "manifest", "EVODEVO_PLUGIN(...)"));
  EXPECT_THAT(refusal("epoch"), naming("ABI epoch", "99", std::to_string(plugin_epoch), rebuild));
  EXPECT_THAT(refusal("manifest_size"), naming("manifest", "8", std::to_string(sizeof(PluginManifest)), rebuild));
  EXPECT_THAT(refusal("structs"), naming("struct", "5", std::to_string(plugin_struct_digest), rebuild));
  EXPECT_THAT(refusal("toolchain"), naming("toolchain", "another compiler", plugin_toolchain, rebuild));
  EXPECT_THAT(refusal("switches"), naming("build switches", "-fpacked", "none", rebuild));
  EXPECT_THAT(refusal("no_entry"), naming("evodevo_plugin", "EVODEVO_PLUGIN(...)"));
  EXPECT_THAT(refusal("unknown_kind"), naming("operator \"nothing\"", "\"wing\"", rebuild));
  EXPECT_THAT(refusal("twin"), naming("mutation operator \"nothing\"", "twice", "rename"));
  EXPECT_THAT(refusal("default"), naming("mutation operator \"nothing\"", "genes = 7", "0 to 5", "correct"));
  EXPECT_THAT(refusal("constructor"),
              naming("mutation operator \"nothing\"", "\"no licence\"", "constructor", "parameters()"));
  EXPECT_THAT(refusal("undefined_symbol"),
              testing::at_place("cannot be loaded: ", "undefined symbol", "nobody", "link", "-Wl,-z,defs"));
  EXPECT_THAT(refusal("borrowed_entry"),
              naming("evodevo_plugin of its own", faulty("sound/plugin.evodevo.so").string(), "EVODEVO_PLUGIN(...)"));
}

TEST(Loader, TextsThatDisturbATerminalAreRefused) {
  const auto of_text = [](const char* place, const char* value) {
    return naming(place, value, "300 bytes", "UTF-8", "control characters", "correct");
  };
  EXPECT_THAT(refusal("controls_in_name"), of_text("mutation operator", "\"noth\\x1b[31ming\""));
  EXPECT_THAT(refusal("controls_in_summary"), of_text("summary", "\"Changes\\nnothing.\""));
  EXPECT_THAT(refusal("controls_in_version"), of_text("version", "\"1.0\\x07\""));
  EXPECT_THAT(refusal("controls_in_licence"), of_text("licence", "\"MIT\\x07\""));
}

TEST(Loader, OnlyLibrariesAreLoadedAndNothingElseDisturbsThem) {
  const testing::Scratch scratch;
  scratch.write("text.evodevo.so", "this is no library");
  fs::create_directory(scratch / "folder.evodevo.so");
  fs::create_symlink("/dev/zero", scratch / "zero.evodevo.so");
  ASSERT_EQ(mkfifo((scratch / "pipe.evodevo.so").c_str(), 0600), 0);
  const Registry registry({scratch / "", faulty("sound")});
  EXPECT_EQ(registry.failed().size(), 4u);
  for (const auto& [file, reason] : registry.failed()) {
    const bool is_text = file == scratch / "text.evodevo.so";
    EXPECT_THAT(reason, naming("; ", is_text ? "build" : "file", "remove"));
    EXPECT_THAT(reason, ::testing::MatchesRegex(is_text ? "cannot be loaded: .*text.evodevo.so.*" : ".*file.*"));
  }
  EXPECT_NE(registry.find("mutation", "nothing"), nullptr);
}

TEST(Loader, WhatAManifestLacksIsNamedAndDisturbsNoOther) {
  const struct {
    const char *library, *place, *what, *remedy;
  } faults[] = {{"null_kind", "operator 0", "kind", "EVODEVO_PLUGIN(...)"},
                {"null_name", "operator 0", "name", "EVODEVO_PLUGIN(...)"},
                {"empty_name", "operator 0", "name", "EVODEVO_PLUGIN(...)"},
                {"null_summary", "operator 0", "summary", "EVODEVO_PLUGIN(...)"},
                {"null_create", "operator 0", "creates", "operator_entry<Class>(...)"},
                {"creates_null", "mutation operator \"nothing\"", "class", "operator_entry<Class>(...)"},
                {"other_class", "devo operator \"nothing\"", "class", "operator_entry<Class>(...)"},
                {"null_toolchain", "toolchain", plugin_toolchain, rebuild},
                {"null_version", "version", "missing", "EVODEVO_PLUGIN(...)"},
                {"empty_licence", "licence", "missing", "EVODEVO_PLUGIN(...)"},
                {"null_entries", "list of operators", "no", "EVODEVO_PLUGIN(...)"},
                {"constructor_throws_a_number", "mutation operator \"nothing\"", "std::exception", "must not throw"},
                {"static_throws", "while it is loaded", "crashes", "remove"}};
  std::vector<fs::path> all;
  for (const auto& [fault, place, what, to_do] : faults) {
    EXPECT_THAT(refusal(fault), naming(place, what, "; ", to_do)) << fault;
    all.push_back(faulty(fault));
  }
  all.push_back(faulty("sound"));
  const Registry registry(all);
  EXPECT_EQ(registry.failed().size(), std::size(faults));
  EXPECT_NE(registry.find("mutation", "nothing"), nullptr) << "of the sound library, which came last";
}

/// An operator with one parameter of the given name.
struct Named final : Operator {
  std::string name;
  double value = 1;
  void parameters(Parameters& p) override { p.real(value, name, {0, 1, "1"}, "A parameter of any name."); }
};

TEST(Loader, NoParameterTakesAKeyOfTheHost) {
  EXPECT_THAT(refusal("reserved"), naming("mutation operator \"nothing\"", "parameter \"every\"", "rename"));
  Named op;
  for (const char* key :
       {"name", "mass", "probability", "from", "to", "every", "label", "over", "over_lives", "remeasure"}) {
    op.name = key;
    EXPECT_EQ(taken_name(op), key);
  }
  op.name = "masses";
  EXPECT_EQ(taken_name(op), "");
}

/// An operator with a fault in each declaration but the first.
struct Undeclared final : Operator {
  double value = 1;
  std::int64_t count = 1;
  void parameters(Parameters& p) override {
    p.real(value, "sound", {0, 1, "N"}, "A parameter without a fault.");
    p.real(value, "sound", {0, 1, "N"}, "A parameter without a fault.");
    p.real(value, "endless", {.low = 0, .unit = "N"}, "A parameter without bounds.");
    p.integer(count, "unitless", {0, 1, ""}, "A parameter without a unit.");
    p.real(value, "terse", {0, 1, "N"}, "A force.");
    p.real(value, "unstopped", {0, 1, "N"}, "A parameter without a full stop");
    p.real(value, "", {0, 1, "N"}, "A parameter without a name.");
  }
};

TEST(Declarations, EachFaultIsNamed) {
  Undeclared op;
  EXPECT_THAT(declaration_faults(op),
              ::testing::ElementsAre(naming("\"sound\"", "twice"), naming("\"endless\"", "finite bounds"),
                                     naming("\"unitless\"", "no unit", "\"1\""), naming("\"terse\"", "sentence"),
                                     naming("\"unstopped\"", "full stop"), naming("\"\"", "no name")));
}

TEST(Loader, WhatALibraryChangesWhileItIsLoadedIsPutBackAndNamed) {
  ASSERT_EQ(std::fegetround(), FE_TONEAREST);
  const std::string said = testing::warnings_of(
      [] { EXPECT_NE(Registry({faulty("rounds")}).find("mutation", "nothing"), nullptr) << "it is used"; });
  EXPECT_EQ(std::fegetround(), FE_TONEAREST);
  EXPECT_THAT(said, naming("warning: ", "rounds/plugin.evodevo.so: ", "the rounding mode"));
}

TEST(Loader, ALibraryThatCrashesIsRefusedAndDisturbsNoOther) {
  const fs::path sound = faulty("sound");
  EXPECT_THAT(refusal("crash", {sound}), naming("crashes", "Segmentation fault", "static objects", "remove"));
  EXPECT_THAT(refusal("exit", {sound}), naming("crashes", "exit code 3", "static objects", "remove"));
  const testing::Scratch scratch;
  fs::copy_file(faulty("crash/plugin.evodevo.so"), scratch / "a.evodevo.so");
  fs::copy_file(sound / "plugin.evodevo.so", scratch / "b.evodevo.so");
  const Registry registry({scratch / ""});
  EXPECT_NE(registry.find("mutation", "nothing"), nullptr) << "in the same folder, behind the one that crashes";
}

TEST(Loader, WhereOperatorsAreLookedFor) {
  setenv("EVODEVO_PLUGIN_PATH", "/one::/two", 1);
  EXPECT_THAT(plugin_search_path({"/mine"}), ::testing::ElementsAre("/mine", "/one", "/two", builtin_plugin_folder()));
  unsetenv("EVODEVO_PLUGIN_PATH");
  EXPECT_THAT(plugin_search_path({}), ::testing::ElementsAre(builtin_plugin_folder()));
}

TEST(Loader, AnotherBuildHasAnotherHash) {
  const auto hash = [](const char* name) { return file_hash(faulty(name) / "plugin.evodevo.so"); };
  EXPECT_EQ(hash("sound"), hash("sound"));
  EXPECT_NE(hash("sound"), hash("newer"));
}

TEST(Loader, OfTwoLibrariesWithOneNameTheSecondIsRefusedWithBothFiles) {
  const fs::path own = faulty("taken_name"), built_in = builtin_plugin_folder() / "reset-weight.evodevo.so";
  const auto twin = [](const fs::path& first) {
    return naming("mutation operator \"reset-weight\"", first.string(), "rename", "plugin path");
  };
  EXPECT_THAT(refusal("taken_name", {builtin_plugin_folder()}), twin(built_in));
  const Registry registry({own, builtin_plugin_folder()});
  ASSERT_EQ(registry.failed().size(), 1u);
  EXPECT_EQ(registry.failed()[0].file, built_in);
  EXPECT_THAT(registry.failed()[0].reason, twin(own / "plugin.evodevo.so"));
  EXPECT_EQ(registry.find("mutation", "reset-weight")->file, own / "plugin.evodevo.so");
}

/// Tests the message for a folder without read permission. Root may read all folders, so as root the test switches to
/// another user.
TEST(Loader, AFolderThatIsNotThereOrWithoutPermissionIsNamed) {
  const auto absent = refused({"/no/such/folder"});
  EXPECT_EQ(absent.file, "/no/such/folder");
  EXPECT_THAT(absent.reason, naming("No such file or directory", "plugin path"));
  const testing::Scratch scratch;
  fs::create_directory(scratch / "closed");
  fs::permissions(scratch / "closed", fs::perms::none);
  fs::permissions(scratch / ".", fs::perms(0755));  // so that the other user gets that far
  const bool root = geteuid() == 0;
  if (root && seteuid(65534) != 0) GTEST_SKIP() << "root cannot switch to another user";
  const auto [file, reason] = refused({scratch / "closed"});
  ASSERT_TRUE(!root || seteuid(0) == 0);
  EXPECT_EQ(file, scratch / "closed");
  EXPECT_THAT(reason, naming("Permission denied", "readable", "plugin path"));
}

const OperatorTitle* title(const char* name) { return lasting_title("devo", name, "/a folder (1)/ö.evodevo.so"); }

TEST(OperatorCall, NamesAllThatIsKnown) {
  EXPECT_EQ(text_of({title("erosion"), {.individual = 5, .cycle = 3}, 7}),
            "devo operator \"erosion\" of /a folder (1)/ö.evodevo.so, individual 5, cycle 3, seed 7");
  EXPECT_EQ(text_of({title("erosion"), {.individual = 0}}),
            "devo operator \"erosion\" of /a folder (1)/ö.evodevo.so, individual 0");
  EXPECT_EQ(title("erosion"), title("erosion")) << "it lasts, and there is one";
}

TEST(OperatorCall, IsKnownWhileItLasts) {
  EXPECT_EQ(current_call().title, nullptr);
  in_operator({title("outer"), {.individual = 1}}, [&] {
    in_operator({title("inner")}, [&] { EXPECT_EQ(current_call().title, title("inner")); });
    EXPECT_EQ(current_call().title, title("outer"));
    EXPECT_EQ(current_call().subject.individual, 1);
  });
  EXPECT_EQ(current_call().title, nullptr);
  EXPECT_THROW(in_operator({title("throws")}, [] { throw 7; }), std::runtime_error);
  EXPECT_EQ(current_call().title, nullptr);
}

TEST(OperatorCall, IsSeenByOtherThreads) {
  std::vector<std::string> seen;
  std::vector<std::uint64_t> numbers;
  const auto look = [&] {
    std::thread([&] {
      for_each_call([&](const void*, std::uint64_t number, const OperatorCall& call) {
        seen.push_back(text_of(call));
        numbers.push_back(number);
      });
    }).join();
  };
  const OperatorCall call{title("erosion"), {.individual = 5}, 7};
  look();
  EXPECT_TRUE(seen.empty());
  in_operator(call, [&] { look(), look(); });
  in_operator(call, look);
  ASSERT_EQ(seen.size(), 3u);
  EXPECT_EQ(seen[0], text_of(call));
  EXPECT_EQ(numbers[0], numbers[1]) << "it is one call";
  EXPECT_NE(numbers[1], numbers[2]) << "it is another";
}

/// Returns the message about an operator that changes process state twice.
std::string said_of(const char* name, void (*change)()) {
  return testing::warnings_of([&] {
    for (int i = 0; i < 2; ++i) in_operator({title(name)}, change);
  });
}

TEST(OperatorCall, WhatItChangesForAllIsPutBackAndNamedOnce) {
  const auto expect_named_once = [&](const char* name, const std::string& what, void (*change)()) {
    const std::string said = said_of(name, change);
    EXPECT_THAT(said, testing::at_place("warning: " + title(name)->whole + ": ", what, "remove"));
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  };
  const std::string locale_before = std::setlocale(LC_ALL, nullptr);
  expect_named_once("rounds", "the rounding mode", [] { std::fesetround(FE_TOWARDZERO); });
  EXPECT_EQ(std::fegetround(), FE_TONEAREST);
  expect_named_once("sets locale", "the locale", [] { std::setlocale(LC_ALL, "C.UTF-8"); });
  EXPECT_EQ(std::setlocale(LC_ALL, nullptr), locale_before);
  expect_named_once("sets C++ locale", "the locale", [] { std::locale::global(std::locale("C.UTF-8")); });
  EXPECT_EQ(std::locale(), std::locale::classic());
  static const locale_t other = newlocale(LC_ALL_MASK, "C.UTF-8", nullptr);
  expect_named_once("sets thread's locale", "the locale", [] { uselocale(other); });
  EXPECT_EQ(uselocale(nullptr), LC_GLOBAL_LOCALE);
#if defined(__x86_64__)
  expect_named_once("flushes", "flush-to-zero", [] { __builtin_ia32_ldmxcsr(__builtin_ia32_stmxcsr() | 0x8040); });
  volatile float small = 1e-38F;
  EXPECT_GT(small / 16, 0);
#endif
  EXPECT_EQ(said_of("behaves", [] { std::feraiseexcept(FE_INEXACT); }), "");
}

/// Every call of an experiment's operators states its operator, individual, cycle and seed.
TEST(OperatorCall, KnowsWhoseLifeItIs) {
  const Experiment experiment = testing::read(testing::small_experiment);
  const auto asked =
      call_operator(experiment.call_of(Devo::kind, 0, {.individual = 3, .cycle = 2}), [] { return current_call(); });
  EXPECT_THAT(text_of(asked),
              ::testing::MatchesRegex("devo operator \"spring-turnover\" of .*, individual 3, cycle 2, seed 7"));
  const auto fails = [&] { call_operator(experiment.call_of(Fitness::kind, 1, {.individual = 3}), [] { throw 7; }); };
  EXPECT_THAT(testing::refusal<std::runtime_error>(fails),
              naming("individual 3, seed 7: ", "std::exception", "correct the operator"));
}

constexpr unsigned seconds = 60;

TEST(Isolation, GivesWhatTheWorkReturns) {
  const std::string with_zeros("a\0b\0", 4), large(3'000'000, 'x');
  EXPECT_EQ(in_child([&] { return with_zeros; }, seconds).text, with_zeros);
  EXPECT_EQ(in_child([&] { return large; }, seconds).text, large);
  EXPECT_EQ(in_child([] { return std::string(); }, seconds).crash, "");
}

TEST(Isolation, SaysHowAProcessEndedAndLetsNothingUnwindIntoTheParentsCode) {
  const pid_t parent = getpid();
  const auto crash = [&](const std::function<void()>& work) {
    const ChildEnd end = in_child([&] { return work(), std::string("done"); }, seconds);
    EXPECT_EQ(getpid(), parent) << "a child has come back";
    return end.crash;
  };
  EXPECT_EQ(crash([] { std::raise(SIGSEGV); }), "Segmentation fault");
  EXPECT_THAT(crash([] { std::exit(0); }), naming("exit code 0"));
  EXPECT_THAT(crash([] { _exit(7); }), naming("exit code 7"));
  EXPECT_EQ(crash([] { std::abort(); }), "Aborted");
  EXPECT_EQ(crash([] { std::fputs("a\nAssertion 'n < size' failed.\n", stderr), std::abort(); }),
            "Aborted, after it said: Assertion 'n < size' failed.");
  EXPECT_THAT(crash([] { std::fputs(std::string(3'000'000, 'e').c_str(), stderr), std::abort(); }), naming("Aborted"));
  EXPECT_THAT(crash([] { throw std::runtime_error("no licence"); }), naming("\"no licence\""));
  EXPECT_THAT(crash([] { throw 7; }), naming("std::exception"));
  EXPECT_NE(crash([] { pthread_exit(nullptr); }), "");
}

TEST(Isolation, EndsWhatDoesNotEndByItself) {
  const ChildEnd end = in_child(
      []() -> std::string {
        alarm(0);
        std::signal(SIGTERM, SIG_IGN);
        while (true) pause();
      },
      1);
  EXPECT_TRUE(end.timed_out);
  EXPECT_THAT(end.crash, naming("1 s"));
}

TEST(Isolation, WaitsForNoProcessThatAChildLeavesBehind) {
  const testing::Scratch scratch;
  const auto leave_one_behind = [&] {
    const pid_t left = fork();
    if (left == 0) {
      setpgid(0, 0);  // so that this process is not killed together with the child
      while (access((scratch / "").c_str(), F_OK) == 0) usleep(1000);
      _exit(0);
    }
    return std::to_string(left);
  };
  EXPECT_NE(in_child(leave_one_behind, seconds).text, "") << "the process left behind keeps the pipe open";
}  // the removal of the folder ends the process left behind

TEST(Isolation, WritesNothingTwice) {
  const testing::Scratch scratch;
  std::FILE* file = std::fopen((scratch / "lines").c_str(), "w");
  std::fputs("once\n", file);  // stays in the buffer, which the child inherits
  in_child([] { return std::exit(0), std::string(); }, seconds);
  in_child([] { return std::string(); }, seconds);
  std::fclose(file);
  EXPECT_EQ(testing::content_of(scratch / "lines"), "once\n");
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
