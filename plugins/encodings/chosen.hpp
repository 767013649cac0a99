// What the encodings share: the check that a body can come of the chosen materials.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "evodevo/encoding.hpp"

/// Why no body can be made of these of the context's materials; empty where one can.
inline std::string why_no_body(const evodevo::EncodingContext& context, const std::vector<std::int32_t>& chosen) {
  const bool solid = std::any_of(chosen.begin(), chosen.end(), [&](auto i) { return !is_air(context.materials[i]); });
  return solid ? "" : "all materials to choose from are air";
}
