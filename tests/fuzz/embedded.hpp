// What a page of report or gallery embeds.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "fuzz/target.hpp"
#include "report/page.hpp"

namespace evodevo {

using Json = nlohmann::ordered_json;

/// Puts data into a page, and returns what a browser would read there. Ends the program if a browser could take them
/// for markup, or an editor for several lines.
inline Json embedded(const Json& data) {
  const std::string before = "<script>", after = "</script>";
  const std::string page = filled_page(before + "EVODEVO_DATA" + after, data);
  const std::string text = page.substr(before.size(), page.size() - before.size() - after.size());
  const auto is_control = [](unsigned char byte) { return byte < 0x20 || byte == 0x7f; };
  require(page.starts_with(before) && page.ends_with(after), "a page changes around its data");
  require(text.find('<') == std::string::npos, "markup in the data of a page");
  require(std::none_of(text.begin(), text.end(), is_control), "control characters in the data of a page");
  for (std::size_t at = 0; (at = text.find('\xc2', at)) != std::string::npos; ++at)
    require(static_cast<unsigned char>(text.at(at + 1)) >= 0xa0, "control characters in the data of a page");
  for (const char* end : {"\u2028", "\u2029"})
    require(text.find(end) == std::string::npos, "ends of lines in the data of a page");
  return Json::parse(text);
}

}  // namespace evodevo
