// The keys that the host itself reads from the tables of operators, whichever operator a table names.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace evodevo::host_key {

inline constexpr std::string_view name = "name", mass = "mass", probability = "probability", from = "from", to = "to",
                                  every = "every", sections = "sections", label = "label", over = "over",
                                  over_lives = "over_lives", remeasure = "remeasure";

inline constexpr std::array all{name, mass, probability, from, to, every, sections, label, over, over_lives, remeasure};

/// Returns whether a key is reserved, so that no operator may have a parameter of this name.
constexpr bool is_reserved(std::string_view key) { return std::find(all.begin(), all.end(), key) != all.end(); }

}  // namespace evodevo::host_key
