// An edge colouring of a body: no two springs of a colour share a mass, so that all springs of a colour can be solved
// at the same time.
#pragma once

#include <cstdint>
#include <vector>

#include "evodevo/body.hpp"

namespace evodevo {

/// The colour of every spring, counted from 0. Springs are coloured in descending order of the sum of their two masses'
/// degrees (numbers of springs); springs with equal sums keep the body's order. Each spring gets the lowest colour that
/// no other spring at its two masses has. The number of colours is less than twice the highest degree.
std::vector<std::uint32_t> spring_colours(const Body& body);

}  // namespace evodevo
