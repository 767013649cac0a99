// Springs in colours: no two of one colour share a mass, so that a colour's springs can be handled all at once.
#pragma once

#include <cstdint>
#include <vector>

#include "evodevo/body.hpp"

namespace evodevo {

/// The colour of every spring, from 0: the lowest that is free at both ends, springs between the most connected masses
/// first and in the body's order where they are equal. Fewer than twice the highest number of springs at a mass.
std::vector<std::uint32_t> spring_colours(const Body& body);

}  // namespace evodevo
