#include "base/json_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace evodevo {
namespace {

/// A character in UTF-8.
struct Character {
  unsigned number = 0;
  std::size_t bytes = 1;
};

/// Returns the character that a text begins with if it is a control character from U+007F on, or one that ends a line
/// or a paragraph; otherwise one byte.
Character first_of(std::string_view text) {
  const auto byte = [&](std::size_t at) { return at < text.size() ? static_cast<unsigned char>(text[at]) : 0u; };
  if (byte(0) == 0xc2 && byte(1) < 0xa0) return {byte(1), 2};
  if (byte(0) == 0xe2 && byte(1) == 0x80 && (byte(2) == 0xa8 || byte(2) == 0xa9)) return {0x2000 + byte(2) - 0x80, 3};
  return {byte(0), 1};
}

}  // namespace

std::string json_text(const nlohmann::ordered_json& json, int indentation) {
  // dump() escapes the control characters below U+0020
  const std::string dumped = json.dump(indentation, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  std::string text;
  text.reserve(dumped.size());
  for (std::string_view left = dumped; !left.empty();) {
    const auto [number, bytes] = first_of(left);
    if (bytes > 1 || number == 0x7f)
      text += fmt::format("\\u{:04x}", number);
    else
      text += left.front();
    left.remove_prefix(bytes);
  }
  return text;
}

}  // namespace evodevo
