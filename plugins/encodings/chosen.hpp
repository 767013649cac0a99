// Shared by the encodings: the check that a body can be made of the chosen materials.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "evodevo/encoding.hpp"

/// Returns the reason why no body can be made of the chosen materials, or an empty text if one can. `chosen` has
/// indices into the context's materials.
inline std::string why_no_body(const evodevo::EncodingContext& context, const std::vector<std::int32_t>& chosen) {
  const bool solid = std::any_of(chosen.begin(), chosen.end(), [&](auto i) { return !is_air(context.materials[i]); });
  return solid ? "" : "all materials to choose from are air";
}
