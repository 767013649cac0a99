// Reads and writes bodies as JSON.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "evodevo/body.hpp"

namespace evodevo {

/// A body in a file, and its state if it is in the middle of its life.
struct GivenBody {
  Body body;
  std::optional<State> state = {};             ///< state in the middle of the life; none if the body is not born yet
  std::vector<std::uint64_t> identities = {};  ///< of the masses (DevoContext::identity()); empty: their indices
};

/// Returns a body as JSON, in SI units. The numbers read back as the same bits.
///
///   masses     a list of {"position", "velocity", "mass", "material", "identity"}: m, m/s, kg, an index, and a whole
///              number that stands for what the mass descends from
///   springs    a list of {"a", "b", "rest_length", "material"}: indices of two masses, m and an index
///   materials  a list of {"name", "stiffness", "amplitude", "frequency", "phase", "damping"}: N/m, 1, Hz, rad and 1
///   time       time since birth, s
///   start_energy  energy that the energy guard allows (State::start_energy), J
///
/// With "time", the body is in the middle of its life: the positions are the present ones, and each "mass" includes the
/// payload that the mass carries. Without "time", the body is not born yet: the positions are its rest positions, it
/// has neither "velocity" nor "start_energy", and at birth the scene adds its payload and puts the body on the ground.
/// These keys may be left out: "name", the "material" of a mass, "identity" (then the index), "damping" and "velocity"
/// (then 0), and "start_energy" (then the energy that the body has in the scene).
std::string body_to_json(const GivenBody& given, const std::vector<std::string>& material_names);

/// Reads a body from a file in this format. Throws a ConfigError that gives the file, the place and a remedy if the
/// file cannot be read or its JSON is not as described above: for example, if a key is unknown or occurs twice, an
/// index is out of range, or a number is not finite or has the wrong sign.
GivenBody read_body(const std::string& file);

}  // namespace evodevo
