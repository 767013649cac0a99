// Bodies as JSON files.
#pragma once

#include <string>
#include <vector>

#include "evodevo/body.hpp"

namespace evodevo {

/// {"masses": [{"position", "mass", "material"?}], "springs": [{"a", "b", "rest_length", "material"}], "materials":
/// [{"name"?, "stiffness", "amplitude", "frequency", "phase"}]} in SI units. Positions are `places`; materials are
/// indices. `names` are those of the first materials.
std::string body_to_json(const Body& body, const std::vector<Vec3>& places, const std::vector<std::string>& names);

/// The body in a file of this form, at rest at its positions. Throws ConfigError that names file, place and remedy for
/// a file that cannot be read, is no such JSON, or holds an index out of range, a pair joined twice, or a number that
/// is not finite or has the wrong sign.
Body read_body(const std::string& file);

}  // namespace evodevo
