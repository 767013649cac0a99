// From an encoding's blueprint to a body that can be simulated.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/neighbours.hpp"
#include "evodevo/encoding.hpp"
#include "threads/parallel.hpp"

namespace evodevo {

/// A finished body, or why there is none.
struct BuiltBody {
  Body body;
  std::string failure;              ///< empty where there is a body
  std::vector<std::uint32_t> kept;  ///< which of the blueprint's masses the body's are, ascending
};

/// Throws std::invalid_argument, naming the fault, where the blueprint's indices or numbers make no body at all. Places
/// and sizes that are not finite are no such fault: networks may give them, and the body is then an invalid one.
void check_blueprint(const Blueprint& blueprint, const EncodingContext& context);

/// Joins the neighbours that the blueprint asks for, leaves out springs of air (and counts them as contacts), drops
/// masses without springs, keeps the largest piece, and moves the rest positions so that the lowest is at z = 0 and the
/// centre of mass over the origin.
BuiltBody build_body(Blueprint blueprint);

/// The same for a population, whose neighbours are searched for together.
std::vector<BuiltBody> build_bodies(std::vector<Blueprint> blueprints, NeighbourSearch& search, Workers& workers);

/// Spreads a payload of `share` times the body's mass evenly over the masses in the upper part `top` of its height.
void add_payload(Body& body, double share, double top);

std::vector<Vec3> rest_positions(const Body& body);

/// Whether masses do not all lie in one point. Those of a flat or a straight body do not.
bool has_extent(std::span<const Vec3> positions);

/// The masses that springs do not tie to the largest piece, ascending.
std::vector<std::uint32_t> loose_masses(const Body& body);

}  // namespace evodevo
