// The JSON texts that commands print.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace evodevo {

/// Returns `json` as indented text. Control characters that JSON allows unescaped are escaped as well, and bytes that
/// are not UTF-8 are replaced with the character U+FFFD.
std::string json_text(const nlohmann::ordered_json& json);

}  // namespace evodevo
