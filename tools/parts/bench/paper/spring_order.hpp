// The order of a body's springs in the spring buffer. It determines which threads add forces to the same mass at the
// same time.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "evodevo/body.hpp"

namespace evodevo::tools::bench {

enum class SpringOrder {
  as_built,
  by_first_mass,
  shuffled,
  spread,  ///< as far as possible, no two springs of a warp (32 consecutive springs) share a mass
};
inline constexpr std::array<SpringOrder, 4> spring_orders{SpringOrder::as_built, SpringOrder::by_first_mass,
                                                          SpringOrder::shuffled, SpringOrder::spread};

std::string name(SpringOrder order);

/// Returns the indices of the body's springs in the given order.
std::vector<std::uint32_t> ordered_springs(const Body& body, SpringOrder order);

}  // namespace evodevo::tools::bench
