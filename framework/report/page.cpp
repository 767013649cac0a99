#include "report/page.hpp"

#include <boost/dll/runtime_symbol_info.hpp>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "base/json_text.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t largest_page = 30'000'000;  ///< bytes
constexpr const char* page_name = "page.html";
constexpr std::string_view place_of_data =
    "EVODEVO_DATA";  ///< placeholder for the data in a script element of the page

std::string escaped(const std::string& json) {
  std::string text;
  text.reserve(json.size());
  for (const char c : json) {
    if (c == '<')
      text += "\\u003c";  // so that "</script>" in a JSON string, the only place for a "<", does not end the element
    else
      text += c;
  }
  return text;
}

/// The folder that holds bin/evodevo.
fs::path program_prefix() { return fs::path(boost::dll::program_location().string()).parent_path().parent_path(); }

/// The folder of the viewer, if it has been built.
fs::path built_viewer() { return program_prefix() / EVODEVO_VIEWER_DIR; }

}  // namespace

fs::path viewer_folder() {
  const fs::path prefix = program_prefix();
  fs::path folder = built_viewer();
  const bool is_build = fs::exists(prefix / "CMakeCache.txt");
  if (!fs::exists(folder / page_name))
    throw std::runtime_error(folder.string() +
                             ": the viewer has not been built. It needs Node.js 18 or newer with npm (Debian: apt-get "
                             "install nodejs npm); then `cmake --build " +
                             (is_build ? prefix.string() : "BUILD") + " --target evodevo_viewer`" +
                             (is_build ? "" : " where evodevo was built, and install it again") +
                             ", or use tools/evodevo, which does both");
  return folder;
}

bool has_viewer() { return fs::exists(built_viewer() / page_name); }

std::string page_template() {
  std::ifstream stream(viewer_folder() / page_name);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::string filled_page(const std::string& page, const nlohmann::ordered_json& data) {
  const auto at = page.find(place_of_data);
  if (at == std::string::npos) throw std::runtime_error("the page of the viewer has no place for data; build it again");
  return page.substr(0, at) + escaped(json_text(data, -1)) + page.substr(at + place_of_data.size());
}

std::string self_reloading(const std::string& page, const std::string& path, const std::string& shown) {
  constexpr std::string_view policy = "default-src 'none';", end = "</body>";
  const auto at_policy = page.find(policy), at_end = page.rfind(end);
  if (at_policy == std::string::npos || at_end == std::string::npos)
    throw std::runtime_error("the page of the viewer has no place for the program that reloads it; build it again");
  const std::string program = "<script>setInterval(() => fetch(\"" + path +
                              "\").then((answer) => answer.text()).then((text) => {"
                              " if (text !== \"" +
                              shown +
                              "\") location.reload();"
                              " }).catch(() => {}), 5000);</script>";
  return page.substr(0, at_policy) + std::string(policy) + " connect-src 'self';" +
         page.substr(at_policy + policy.size(), at_end - at_policy - policy.size()) + program + page.substr(at_end);
}

std::string size_note(const std::string& file, std::size_t bytes, const std::string& option) {
  if (bytes <= largest_page) return {};
  return "evodevo: " + file + ": has " + std::to_string(bytes / 1'000'000) + " MB, though only the beginning and the " +
         "end of each motion are kept: pages of more than " + std::to_string(largest_page / 1'000'000) +
         " MB load slowly; show fewer robots with " + option + "\n";
}

}  // namespace evodevo
