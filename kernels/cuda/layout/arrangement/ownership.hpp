// Chooses which of its two masses owns each spring.
#pragma once

#include <cstdint>
#include <span>

#include "cuda/layout/arrangement/outline.hpp"

namespace evodevo::cuda {

/// The value of an owner or a row that has not been chosen yet.
inline constexpr std::uint32_t open = 0xffffffff;

/// Sets `owner` to the index of the mass that owns each spring inside. Springs are spread evenly over the masses (the
/// lanes of each group) and over the banks to which each group's springs lead. `index_of` is the device index of each
/// mass. An owner that is given (not `open`) must be one of the spring's masses; most given owners are kept.
void choose_owners(const Outline& outline, std::span<const std::uint32_t> index_of, std::uint32_t groups,
                   std::span<std::uint32_t> owner);

}  // namespace evodevo::cuda
