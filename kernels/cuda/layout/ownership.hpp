// Which of its two masses owns a spring.
#pragma once

#include <cstdint>
#include <span>

#include "evodevo/body.hpp"

namespace evodevo::cuda {

/// In `owner`, for an owner or a row that is not chosen yet.
inline constexpr std::uint32_t open = 0xffffffff;

/// Chooses the place of the mass that owns each spring. Spreads the springs evenly over the masses, which are a group's
/// lanes, and over the banks that each group's springs lead to. `index_of` gives each mass's place. Where an owner is
/// given in `owner`, it is one of the spring's two and hardly needs to change.
void choose_owners(const Body& body, std::span<const std::uint32_t> index_of, std::uint32_t groups,
                   std::span<std::uint32_t> owner);

}  // namespace evodevo::cuda
