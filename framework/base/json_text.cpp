#include "base/json_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace evodevo {

std::string json_text(const nlohmann::ordered_json& json) {
  const std::string dumped = json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  std::string text;
  for (std::size_t i = 0; i < dumped.size(); ++i) {
    // dump() has escaped the control characters below U+0020. In UTF-8, U+0080 to U+009F are two bytes: 0xc2 and the
    // number itself.
    const auto byte = [&](std::size_t at) { return at < dumped.size() ? static_cast<unsigned char>(dumped[at]) : 0u; };
    const bool two_bytes = byte(i) == 0xc2 && byte(i + 1) < 0xa0;
    if (byte(i) != 0x7f && !two_bytes) {
      text += dumped[i];
      continue;
    }
    if (two_bytes) ++i;
    text += fmt::format("\\u{:04x}", byte(i));
  }
  return text;
}

}  // namespace evodevo
