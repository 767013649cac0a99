// All declarations that cross the border to plugins. Changing any of them requires a higher ABI epoch.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "evodevo/plugin.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;

const fs::path source = EVODEVO_SOURCE_FOLDER;
const fs::path golden = source / "tests/host/plugin_border.txt";

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Returns the position after the brace that closes the one at `open`.
std::size_t behind_braces(const std::string& text, std::size_t open) {
  int depth = 0;
  for (std::size_t i = open; i < text.size(); ++i) {
    depth += (text[i] == '{') - (text[i] == '}');
    if (depth == 0) return i + 1;
  }
  return text.size();
}

/// Returns the declarations of a header, one per line, in their order: types, names, defaults and signatures, without
/// comments, preprocessor lines and bodies of functions. Types and order of members determine their offsets; the order
/// of virtual functions determines their positions in the table.
std::string declarations(std::string text) {
  text = std::regex_replace(text, std::regex("//[^\n]*"), "");
  text = std::regex_replace(text, std::regex("\n#([^\n]*\\\\\n)*[^\n]*"), "\n");
  text = std::regex_replace(text, std::regex("\\s+"), " ");
  static const std::regex scope(" ?(namespace|struct|class|enum|template <[^(]*> (struct|class)) [^(]*");
  std::string lines, line;
  const auto end_line = [&](const char* with) {
    line.erase(0, line.find_first_not_of(' '));
    if (!line.empty() || *with == '}') lines += line + with + "\n";
    line.clear();
  };
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] == ';') {
      end_line(";");
    } else if (text[i] == '}') {
      if (line.find_first_not_of(' ') != std::string::npos) end_line("");
      end_line("}");
    } else if (text[i] != '{') {
      line += text[i];
    } else if (std::regex_match(line, scope)) {
      end_line("{");
    } else {
      const bool is_function = line.find('(') != std::string::npos;
      const std::size_t behind = behind_braces(text, i);
      if (!is_function) line += text.substr(i, behind - i);
      i = behind;
      const std::size_t next = text.find_first_not_of(' ', i);
      const bool goes_on =
          next != std::string::npos && std::string_view(";,{").find(text[next]) != std::string_view::npos;
      if (is_function && !goes_on) end_line(";");
      continue;
    }
    ++i;
  }
  return lines;
}

/// Appends the declarations of all SDK headers that a header includes, and then those of the header itself.
void add_declarations(const std::string& header, std::set<std::string>& seen, std::string& all) {
  if (!seen.insert(header).second) return;
  for (const char* folder : {"framework/sdk", "kernels/include"}) {
    if (!fs::exists(source / folder / header)) continue;
    const std::string text = text_of(source / folder / header);
    static const std::regex include("#include \"([^\"]*)\"");
    for (std::sregex_iterator found(text.begin(), text.end(), include), end; found != end; ++found)
      add_declarations((*found)[1], seen, all);
    all += "\n== " + header + "\n" + declarations(text);
  }
}

std::string border() {
  std::set<std::string> seen;
  std::string all;
  add_declarations("evodevo/plugin.hpp", seen, all);
  return "ABI epoch " + std::to_string(plugin_epoch) + "\n" + all;
}

std::string first_difference(const std::string& then, const std::string& now) {
  std::istringstream then_lines(then), now_lines(now);
  std::string before, after;
  do {
    if (!std::getline(then_lines, before)) before = "nothing";
    if (!std::getline(now_lines, after)) after = "nothing";
  } while (before == after && then_lines);
  return "it was:  " + before + "\nit is:   " + after;
}

TEST(PluginBorder, ChangesWithTheEpochAlone) {
  const std::string then = text_of(golden), now = border();
  if (then == now) return;
  const bool same_epoch = then.substr(0, then.find('\n')) == now.substr(0, now.find('\n'));
  const std::string write_anew =
      "write it down anew: EVODEVO_WRITE_BORDER=1 build/cpu/bin/test_host --gtest_filter='PluginBorder.*'";
  ASSERT_FALSE(same_epoch) << "what crosses the border to plugins has changed.\n"
                           << first_difference(then.substr(then.find('\n') + 1), now.substr(now.find('\n') + 1))
                           << "\nRaise plugin_epoch in framework/sdk/evodevo/plugin.hpp, then " << write_anew;
  if (std::getenv("EVODEVO_WRITE_BORDER") != nullptr)
    std::ofstream(golden) << now;
  else
    FAIL() << golden << " is of another epoch; " << write_anew;
}

TEST(PluginBorder, SeesWhatMovesAndNotWhatIsSaidOfIt) {
  const std::string before = R"(
#include <vector>
#define SOMETHING(x) \
  struct x {}
namespace n {
/// A thing.
struct Thing {
  double low = 0, high = 0;  ///< m
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  Thing(int x) : a(x), b{0} {}
  bool is_low() const { if (low < 0) { return true; } return false; }
};
enum class Kind : int { one, two };
class Op {
 public:
  static constexpr std::array lists{&Thing::low, &Thing::high};
  virtual ~Op() = default;
  virtual void first(const Thing& thing) const = 0;
  virtual void second(const Thing& thing) const { thing.is_low(); }
};
template <class T>
constexpr Thing make(T value) {
  return {value};
}
}  // namespace n
)";
  const auto changed = [&](const std::string& what, const std::string& to) {
    std::string text = before;
    text.replace(text.find(what), what.size(), to);
    return declarations(text) != declarations(before);
  };
  EXPECT_TRUE(changed("a = 0;\n  std::uint32_t b = 0;", "b = 0;\n  std::uint32_t a = 0;")) << "members of one type";
  EXPECT_TRUE(changed("low = 0, high = 0", "high = 0, low = 0"));
  EXPECT_TRUE(changed("std::uint32_t b", "std::int32_t b"));
  EXPECT_TRUE(changed("b = 0", "b = 1"));
  EXPECT_TRUE(changed("one, two", "two, one"));
  EXPECT_TRUE(changed("virtual void first", "virtual void third"));
  EXPECT_TRUE(changed("&Thing::low, &Thing::high", "&Thing::high, &Thing::low"));
  const std::string first = "  virtual void first(const Thing& thing) const = 0;\n",
                    second = "  virtual void second(const Thing& thing) const { thing.is_low(); }\n";
  EXPECT_TRUE(changed(first + second, second + first)) << "virtual functions of one signature";
  EXPECT_TRUE(changed(first, "")) << "and one that goes";
  EXPECT_FALSE(changed("/// A thing.", "/// Another thing."));
  EXPECT_FALSE(changed("return true", "return false")) << "what an inline function does";
  EXPECT_FALSE(changed("  double low = 0, high = 0;", "double low = 0,\n      high = 0;"));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
