// JSON as commands print it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace evodevo {

/// `json` on lines of its own. Control characters that JSON lets stand become escapes, and bytes that are not UTF-8 the
/// character U+FFFD.
std::string json_text(const nlohmann::ordered_json& json);

}  // namespace evodevo
