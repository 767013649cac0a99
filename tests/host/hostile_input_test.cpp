// Malicious experiments and options: each is either read or refused with a clean one-line message that names the
// location.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <random>
#include <sstream>

#include "experiment/toml_limits.hpp"
#include "experiment/toml_reader.hpp"
#include "support/changed.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using ::testing::HasSubstr;
using testing::small_experiment;
using testing::small_with;
using ::testing::StartsWith;

constexpr const char* accepted = "no refusal";

/// Returns the message with which a text is refused, or `accepted`.
std::string complaint(const std::string& text, const std::vector<Override>& overrides = {}) {
  return testing::refusal<ConfigError>([&] { testing::read(text, overrides); });
}

/// Expects that `text` is read, or refused with a clean message that begins with the name of its file or an option.
void expect_read_or_refused(const std::string& text, const std::vector<Override>& overrides = {}) {
  const std::string message = complaint(text, overrides);
  EXPECT_EQ(message, printable(message, InputError::longest_message));
  EXPECT_THAT(message, ::testing::AnyOf(accepted, StartsWith("test.toml"), StartsWith("--set ")));
}

/// Returns the parts of a text between which `|` stands.
std::vector<std::string> parts_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> parts;
  for (std::string part; std::getline(stream, part, '|');) parts.push_back(part);
  return parts;
}

std::string times(std::size_t count, const std::string& part) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += part;
  return text;
}

/// Returns texts with `depth` levels of nesting, each of a different kind.
std::vector<std::string> nested(std::size_t depth) {
  return {"a" + times(depth, ".a") + " = 1",
          "\"a\"" + times(depth, " . 'a'") + " = 1",
          "[a" + times(depth, ".a") + "]",
          "[[a" + times(depth, ".a") + "]]\nb = 1",
          "a = " + times(depth, "[") + times(depth, "]"),
          "a = " + times(depth, "["),
          "a = " + times(depth, "{ a = ") + "1" + times(depth, "}"),
          "a = " + times(depth, "[{ a = ") + "1" + times(depth, "}]"),
          "a = { b" + times(depth, ".b") + " = 1 }",
          "x = \"\"\"\n\\\"\"\"\" # \"\"\"\"\na = " + times(depth, "["),
          "x = '''\n''''' \na" + times(depth, ".a") + " = 1"};
}

TEST(HostileInput, NestedToAnyDepth) {
  for (const std::size_t depth : {1, 7, 20, 21, 22, 255, 256, 257, 5'000, 50'000})
    for (const std::string& text : nested(depth)) {
      SCOPED_TRACE(text.substr(0, 40) + " of depth " + std::to_string(depth));
      expect_read_or_refused(text);
      expect_read_or_refused(small_experiment + text);
    }
}

TEST(HostileInput, TooManyLevelsAreRefusedByPlace) {
  const std::string levels = std::to_string(most_toml_levels);
  const auto message = [](const std::string& text) { return complaint("# ü\nx = 'ü' # [[\n" + text); };
  EXPECT_THAT(message("a" + times(21, ".a") + " = 1"), testing::at_place("test.toml:3:42: ", levels, "dots"));
  EXPECT_THAT(message("ü = " + times(21, "[")), testing::at_place("test.toml:3:25: ", levels, "brackets"));
  EXPECT_THAT(message("a" + times(20, ".a") + " = 1"), ::testing::Not(HasSubstr(levels))) << "as many are read";
}

TEST(HostileInput, DotsAndBracketsCountOnlyWhereTheyMeanLevels) {
  const std::string many = times(1000, ".[{");
  EXPECT_EQ(complaint("# " + many + "\n" + small_experiment), accepted);
  for (const std::string& name :
       {"\"" + many + "\\\"" + many + "\"", "'" + many + "'", "'''\n" + many + "\n''" + many + "'''",
        "\"\"\"" + many + "\\\"\"\"" + many + "\"\"\"\""})
    EXPECT_THAT(complaint("[selection]\nname = " + name), testing::at_place("test.toml:1:1: experiment: ", "missing"))
        << name.substr(0, 9);
  EXPECT_THAT(complaint(small_with({{"seed = 7", "seed = [" + times(1000, "1.5, ") + "]"}})),
              HasSubstr("experiment.seed = [ 1.5, 1.5, "));
}

TEST(HostileInput, OfAnySize) {
  const std::string long_text = times(100'000, "läng");
  for (const std::string& text :
       {"[experiment]\n" + std::string(900'000, 'k') + " = 1", "[experiment]\nseed = '" + long_text + "'",
        "[" + long_text + "]", "[experiment]\nseed = " + std::string(100'000, '9'),
        "[experiment]\nseed = [" + times(200'000, "1, ") + "]", times(100'000, "[[fitness]]\n"),
        "[plugins]\npaths = [" + times(200'000, "'a',") + "]",
        "[encoding]\nname = 'voxel'\nmaterials = [" + times(100'000, "'a',") + "]", times(200'000, "#\n"),
        std::string(5'000'000, ' '), std::string(5'000'000, '\0')}) {
    SCOPED_TRACE(text.substr(0, 30));
    expect_read_or_refused(text);
    expect_read_or_refused(small_experiment + text);
  }
}

TEST(HostileInput, OfAnyBytesAndCutAnywhere) {
  const std::string bom = "\xef\xbb\xbf";
  std::string crlf;
  for (const char c : small_experiment) crlf += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_EQ(complaint(bom + small_experiment), accepted);
  EXPECT_EQ(complaint(crlf), accepted);
  EXPECT_THAT(complaint(small_with({{"seed = 7", std::string("seed = \0", 8)}})), StartsWith("test.toml:3:"));
  EXPECT_THAT(complaint(small_experiment + "\n\"a\\u001b[31m\\n\\u009b\" = 1"),
              testing::naming("a\\x1b[31m\\n\\u009b: ", "[selection]"));
  EXPECT_THAT(complaint(small_experiment + "\n[materials.\"\\u001bbone\"]"),
              testing::naming("materials.\\x1bbone = a table: ", "\"\\x1bbone\"", "control characters"));
  for (std::size_t length = 0; length < small_experiment.size(); length += 7)
    expect_read_or_refused(small_experiment.substr(0, length));
  const std::vector<std::string> odd =
      parts_of("\x1b[2J|\xff|\r|'''|\"\"\"|[[|]|{|}|=|.|..|,|\n|nan|-|1e999|0x|1979-05-27|\\u202e|\u202e|#|ü| |");
  std::mt19937_64 random(20'261);
  for (int i = 0; i < 300; ++i) {
    std::string text = small_experiment;
    for (std::uint64_t changes = 1 + random() % 8; changes > 0; --changes) {
      const std::size_t at = random() % text.size();
      const std::string others[] = {"", std::string(1, static_cast<char>(random() % 256)), odd[random() % odd.size()],
                                    text.substr(random() % text.size(), random() % 40)};
      text.replace(at, random() % 20, others[random() % 4]);
    }
    SCOPED_TRACE(text);
    expect_read_or_refused(text);
  }
}

TEST(HostileInput, OptionsOfAnyShape) {
  const std::string deep = times(50'000, ".a"), long_text(100'000, 'x');
  const std::vector<std::string> keys = parts_of(
      "experiment.seed|experiment.seed.x|experiment|experiment.\x1b[31m|experiment.\xff|a.b|.|..|experiment.|.seed|"
      "experiment..seed|fitness|fitness.0|fitness.0.window|fitness.2|fitness.2.window|fitness.3|fitness.-1.window|"
      "fitness.00.window|fitness.99999999999999999999.window|fitness.0x0.window|fitness.x|scene.drag.coefficient|"
      "scene.floor|materials.a\nb.stiffness|plugins.paths|" +
      long_text + "|experiment" + deep);
  const std::vector<std::string> values = parts_of(
      "| |3|-3|nan|-inf|1e999|99999999999999999999|-99999999999999999999|0x7|7abc|'|'''|\"|\"\"\"|\n|3\nseed = 4|"
      "3 # four|{|{}|{a = 1}|{a = {b = 1}}|[|[]|[[]]|['x']|[{}]|true|\x1b[31m|\xff\xfe|ü|1979-05-27|" +
      long_text + "|" + times(50'000, "[") + "|" + times(50'000, "{a=") + "|{a" + deep + " = 1}");
  for (const std::string& key : keys)
    for (const std::string& value : values) {
      const std::string origin = "--set " + printable(key + "=" + value);
      SCOPED_TRACE(origin);
      expect_read_or_refused(small_experiment, {{key, value, origin}});
    }
}

TEST(HostileInput, NumbersOfOptionsAreRefusedByTheOption) {
  for (const std::string value :
       {"", "nan", "inf", "-1", "99999999999999999999", "-99999999999999999999", "7abc", "1.5", "[7]", "ü"})
    for (const std::string key : {"experiment.seed", "experiment.evaluations", "simulation.threads"}) {
      const std::string option = "--set " + key + "=" + value;
      EXPECT_THAT(complaint(small_experiment, {{key, value, option}}), StartsWith(option + ": ")) << option;
    }
}

TEST(HostileInput, PlacesAreThoseOfTheFileWhateverOptionsSet) {
  const std::pair<std::string, std::string> none{"[simulation]\nthreads = 2\n", ""},
      stiff{"[scene.floor]\n", "[scene.floor]\nstiffness = 1e9\n"};
  const std::string without = small_with({none}), tpu = small_with({{"threads = 2", "device = \"tpu\"\ndt = 7"}});
  for (const std::string& text :
       {small_with({none, stiff}), small_with({stiff}), tpu, small_with({none, {"seed = 7", "seed = -7"}}),
        small_with({none, {"edge = 0.5", "edgy = 0.5"}})}) {
    const std::string plain = complaint(text);
    EXPECT_THAT(plain, StartsWith("test.toml:"));
    EXPECT_EQ(complaint(text, {{"simulation.threads", "1", "--threads 1"}}), plain);
    EXPECT_EQ(complaint(text, {{"development.cycles", "1", "--set development.cycles=1"}}), plain);
  }
  EXPECT_THAT(complaint(tpu, {{"simulation.device", "cpu", "--device cpu"}}),
              StartsWith("test.toml:28:6: simulation.dt = 7"));
  EXPECT_THAT(complaint(without, {{"simulation.device", "tpu", "--device tpu"}}),
              StartsWith("--device tpu: simulation.device"));
  EXPECT_THAT(complaint(without, {{"fitness.2.window", "1", "--set fitness.2.window=1"}}),
              testing::at_place("--set fitness.2.window=1: fitness.2.name: ", "missing"));
}

TEST(HostileInput, FilesThatAreNone) {
  const auto complaint_of_file = [](const std::string& file) {
    return testing::refusal<ConfigError>([&] { read_experiment(ExperimentSource{file, {}}); });
  };
  const testing::Scratch scratch;
  const std::string most = std::to_string(most_toml_file_bytes) + " bytes";
  EXPECT_THAT(complaint_of_file("/dev/zero"), testing::at_place("/dev/zero: ", "cannot be read", most));
  EXPECT_THAT(complaint_of_file(""), testing::at_place("\"\": ", "cannot be read", "No such file"));
  EXPECT_THAT(complaint_of_file(std::string(5000, 'x')), testing::naming("...: ", "File name too long"));
  EXPECT_THAT(complaint_of_file("no\x1b[31m\nfile"),
              testing::at_place("no\\x1b[31m\\nfile: ", "cannot be read", "No such file or directory"));
  EXPECT_THAT(complaint_of_file("/"), testing::at_place("/: cannot be read: ", "folder"));
  const std::string pipe = (scratch / "pipe").string(), link = (scratch / "link").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::filesystem::create_symlink(pipe, link);
  for (const std::string& file : {pipe, link})
    EXPECT_THAT(complaint_of_file(file), testing::at_place(file + ": ", "named pipe", "/dev/stdin"));
  EXPECT_THAT(complaint_of_file("/dev/null"), testing::at_place("/dev/null:1:1: experiment: ", "missing"));
  const std::string large = scratch.write("large.toml", small_experiment + std::string(most_toml_file_bytes, ' '));
  EXPECT_THAT(complaint_of_file(large), testing::at_place(large + ": ", "cannot be read", most));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
