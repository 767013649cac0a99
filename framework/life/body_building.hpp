// Builds bodies that can be simulated from the blueprints of encodings.
#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "analysis/neighbours.hpp"
#include "evodevo/encoding.hpp"
#include "threads/parallel.hpp"

namespace evodevo {

/// What masses or springs remember at birth: a number for each of them, by name.
using MemoryByName = std::map<std::string, std::vector<double>>;

/// A finished body, or the reason why there is none.
struct BuiltBody {
  Body body = {};
  std::string failure = "";              ///< empty if there is a body
  std::vector<std::uint32_t> kept = {};  ///< indices that the body's masses have in the blueprint, ascending
  MemoryByName mass_memory = {}, spring_memory = {};
  std::vector<std::uint64_t> identities = {};  ///< of the body's masses, as the encoding gave them
  std::size_t in_other_pieces = 0;  ///< number of masses that were left out although springs joined them to others
};

/// Throws a std::invalid_argument that names the fault if a blueprint is malformed: for example, if an index is out of
/// range or a mass is 0 kg. Positions that are not finite are accepted here, because neural networks may compute them;
/// build_body() then returns a failure. `names` are those that the encoding declares in Encoding::spring_memory().
void check_blueprint(const Blueprint& blueprint, const EncodingContext& context,
                     const std::vector<std::string>& names = {});

/// Lets an encoding complete a blueprint whose neighbours have been joined (Encoding::joined). Throws a
/// std::invalid_argument that names the fault if the blueprint is malformed afterwards, or has other masses or springs.
void complete(const Encoding& encoding, const EncodingContext& context, Blueprint& blueprint);

/// What is done to a blueprint whose neighbours have been joined, given its number.
using AfterJoining = std::function<void(std::size_t, Blueprint&)>;

/// Joins the neighbours that the blueprint asks for, removes springs of air (and counts them in Mass::air_contacts),
/// removes masses without springs, keeps the largest piece, and moves the rest positions so that the lowest mass is at
/// z = 0 and the centre of mass is over the origin.
BuiltBody build_body(Blueprint blueprint, const AfterJoining& after_joining = {});

/// Does the same for several blueprints. Searches for the neighbours of all of them together.
std::vector<BuiltBody> build_bodies(std::vector<Blueprint> blueprints, NeighbourSearch& search, Workers& workers,
                                    const AfterJoining& after_joining = {});

/// Adds a payload of `share` times the body's mass, spread evenly over the masses in the upper fraction `top` of the
/// body's height. Masses of 0 kg, which never move, carry nothing.
void add_payload(Body& body, double share, double top);

std::vector<Vec3> rest_positions(const Body& body);

/// Returns whether at least two positions differ. This is also true for flat and straight bodies.
bool has_extent(std::span<const Vec3> positions);

/// Returns the masses that no springs connect to the largest piece, in ascending order.
std::vector<std::uint32_t> loose_masses(const Body& body);

}  // namespace evodevo
