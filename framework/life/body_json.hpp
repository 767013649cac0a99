// Bodies as JSON files.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "evodevo/body.hpp"

namespace evodevo {

/// What a file says of a body.
struct GivenBody {
  Body body;
  std::optional<State> state;  ///< of a body in the middle of its life; none where it is yet to be born
};

/// A body as JSON, in SI units; the numbers read back as the same bits.
///
///   masses     a list of {"position", "velocity", "mass", "material"}: m, m/s, kg and an index
///   springs    a list of {"a", "b", "rest_length", "material"}: indices of two masses, m and an index
///   materials  a list of {"name", "stiffness", "amplitude", "frequency", "phase"}: N/m, 1, Hz and rad
///   time       since birth, s
///   start_energy  what the energy guard measures the life by (State), J
///
/// With "time" the body is in the middle of its life: its masses are where they are, as fast as they are, and bear
/// their load. Without, it is yet to be born, where and with what load the scene says: its positions are its rest
/// positions, and it has neither velocities nor start energy. "name", the masses' "material" and what is left of a
/// state (0, and the energy that the state has in its scene) may be left out.
std::string body_to_json(const GivenBody& given, const std::vector<std::string>& material_names);

/// Reads such a file. Throws ConfigError that names file, place and remedy for a file that cannot be read or is no such
/// JSON: keys that are unknown or stand twice, indices out of range, a pair joined twice, numbers that are not finite
/// or have the wrong sign.
GivenBody read_body(const std::string& file);

}  // namespace evodevo
