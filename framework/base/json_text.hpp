// The JSON texts that commands print and pages contain.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace evodevo {

/// Returns `json` as indented text; without line breaks if `indentation` is -1. Control characters and ends of lines
/// that JSON allows unescaped are escaped as well, and bytes that are not UTF-8 are replaced with the character U+FFFD.
std::string json_text(const nlohmann::ordered_json& json, int indentation = 1);

}  // namespace evodevo
