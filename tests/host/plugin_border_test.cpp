// All declarations that cross the border to plugins. Changing any of them requires a higher ABI epoch.
#include <gtest/gtest.h>

#include <cstdlib>
#include <regex>
#include <set>
#include <string>

#include "evodevo/plugin.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;

const fs::path source = EVODEVO_SOURCE_FOLDER;
const fs::path golden = source / "tests/host/plugin_border.txt";

/// Returns the position after the brace that closes the one at `open`.
std::size_t behind_braces(const std::string& text, std::size_t open) {
  int depth = 0;
  for (std::size_t i = open; i < text.size(); ++i) {
    depth += (text[i] == '{') - (text[i] == '}');
    if (depth == 0) return i + 1;
  }
  return text.size();
}

/// Returns the declarations of a header in their order: types, names, defaults and signatures, without comments,
/// preprocessor lines and bodies of functions. A type is a line, with its members; so are the functions and constants
/// between two types. Types and order of members determine their offsets; the order of virtual functions determines
/// their positions in the table.
std::string declarations(std::string text) {
  text = std::regex_replace(text, std::regex("//[^\n]*"), "");
  text = std::regex_replace(text, std::regex("\n#([^\n]*\\\\\n)*[^\n]*"), "\n");
  text = std::regex_replace(text, std::regex("\\s+"), " ");
  static const std::regex scope(" ?(namespace|struct|class|enum|template <[^(]*> (struct|class)) [^(]*");
  std::string lines, part;
  int depth = 0;
  const auto end_part = [&](char with) {
    part.erase(0, part.find_first_not_of(' '));
    if (with != ';' && depth == 1) lines.back() = with == '{' ? '\n' : ' ';
    depth += (with == '{') - (with == '}');
    if (!part.empty() || with == '}') lines += part + with + (depth <= 1 && with != ';' ? '\n' : ' ');
    part.clear();
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == ';' || text[i] == '}') {
      end_part(text[i]);
    } else if (text[i] != '{') {
      part += text[i];
    } else if (std::regex_match(part, scope)) {
      end_part('{');
    } else {
      const bool is_function = part.find('(') != std::string::npos;
      const std::size_t behind = behind_braces(text, i), next = text.find_first_not_of(' ', behind);
      if (!is_function) part += text.substr(i, behind - i);
      const bool goes_on =
          next != std::string::npos && std::string_view(";,{").find(text[next]) != std::string_view::npos;
      if (is_function && !goes_on) end_part(';');
      i = behind - 1;
    }
  }
  return lines;
}

/// Appends the declarations of all SDK headers that a header includes, and then those of the header itself.
void add_declarations(const std::string& header, std::set<std::string>& seen, std::string& all) {
  if (!seen.insert(header).second) return;
  for (const char* folder : {"framework/sdk", "kernels/include"}) {
    if (!fs::exists(source / folder / header)) continue;
    const std::string text = testing::content_of(source / folder / header);
    static const std::regex include("#include \"([^\"]*)\"");
    for (std::sregex_iterator found(text.begin(), text.end(), include), end; found != end; ++found)
      add_declarations((*found)[1], seen, all);
    all += "== " + header + " " + declarations(text);
  }
}

std::string border() {
  std::set<std::string> seen;
  std::string all;
  add_declarations("evodevo/plugin.hpp", seen, all);
  return "ABI epoch " + std::to_string(plugin_epoch) + "\n" + all;
}

TEST(PluginBorder, ChangesWithTheEpochAlone) {
  const std::string then = testing::content_of(golden), now = border();
  const bool same_epoch = then.substr(0, then.find('\n')) == now.substr(0, now.find('\n'));
  if (!same_epoch && std::getenv("EVODEVO_WRITE_BORDER") != nullptr)
    std::ofstream(golden) << now;
  else
    EXPECT_EQ(then, now) << "If what crosses the border to plugins has changed, raise plugin_epoch in framework/sdk/"
                            "evodevo/plugin.hpp. Then write it down anew: EVODEVO_WRITE_BORDER=1 "
                            "build/cpu/bin/test_host --gtest_filter='PluginBorder.*'";
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
