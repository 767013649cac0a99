// In which order the springs of a body lie in the spring buffer, and so which threads add forces at the same time.
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
  spread,  ///< no two of 32 springs in a row share a mass, as far as springs last
};
inline constexpr std::array<SpringOrder, 4> spring_orders{SpringOrder::as_built, SpringOrder::by_first_mass,
                                                          SpringOrder::shuffled, SpringOrder::spread};

std::string name(SpringOrder order);

/// The indices of the body's springs in an order.
std::vector<std::uint32_t> ordered_springs(const Body& body, SpringOrder order);

}  // namespace evodevo::tools::bench
