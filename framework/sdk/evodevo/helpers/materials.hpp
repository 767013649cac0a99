// For encodings and devo operators: which materials a body can have, and the material between two masses.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "evodevo/encoding.hpp"

namespace evodevo {

/// Returns the reason why no body can be made of the chosen materials, or an empty text if one can. `chosen` has
/// indices into the context's materials.
inline std::string why_no_body(const EncodingContext& context, const std::vector<std::int32_t>& chosen) {
  const bool solid = std::any_of(chosen.begin(), chosen.end(), [&](auto i) { return !is_air(context.materials[i]); });
  return solid ? "" : "all materials to choose from are air";
}

/// Returns the names of the chosen materials, for the genes that choose among them.
inline std::vector<std::string> names_of(const EncodingContext& context, const std::vector<std::int32_t>& chosen) {
  std::vector<std::string> names;
  for (const std::int32_t i : chosen) names.push_back(context.material_names[i]);
  return names;
}

/// Returns the mean of the materials of two masses (paper, section IV-D2), or nothing if one of them has no material.
inline std::optional<Material> material_between(const Body& body, std::int32_t first, std::int32_t second) {
  if (first == no_material || second == no_material) return std::nullopt;
  return mean(body.materials[first], body.materials[second]);
}

}  // namespace evodevo
