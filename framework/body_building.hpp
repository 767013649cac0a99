// From an encoding's blueprint to a body that can be simulated.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "evodevo/encoding.hpp"
#include "neighbours.hpp"
#include "parallel.hpp"

namespace evodevo {

/// A finished body, or why there is none.
struct BuiltBody {
  Body body;
  std::string failure;              ///< empty where there is a body
  std::vector<std::uint32_t> kept;  ///< which of the blueprint's masses the body's are, ascending
};

/// Joins the neighbours that the blueprint asks for, leaves out springs of air (and counts them as contacts), drops
/// masses without springs, keeps the largest piece, and moves the rest places so that the lowest is at z = 0 and the
/// centre of mass over the origin.
BuiltBody build_body(Blueprint blueprint);

/// The same for a population, whose neighbours are searched for together.
std::vector<BuiltBody> build_bodies(std::vector<Blueprint> blueprints, NeighbourSearch& search, Workers& workers);

}  // namespace evodevo
