// An edge colouring of a body: no two springs of a colour share a mass, so that all springs of a colour can be solved
// at the same time.
#pragma once

#include <cstdint>
#include <vector>

#include "evodevo/body.hpp"

namespace evodevo {

/// The colour of every spring, counted from 0. Springs get their colours in the order of falling degree (number of
/// springs) of their two masses together, equal ones in the body's order; each gets the lowest colour that no spring at
/// its two masses has. There are fewer than twice as many colours as the highest degree.
std::vector<std::uint32_t> spring_colours(const Body& body);

}  // namespace evodevo
