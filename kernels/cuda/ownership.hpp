// Which of its two masses owns a spring.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "evodevo/body.hpp"

namespace evodevo::cuda {

/// For each spring, whether its end b owns it (1) or its end a (0). Spreads the springs evenly over the masses, which
/// are a group's lanes, and over the banks that each group's springs lead to. `place_of` gives each mass's place.
std::vector<std::uint8_t> choose_owners(const Body& body, std::span<const std::uint32_t> place_of,
                                        std::uint32_t groups);

}  // namespace evodevo::cuda
