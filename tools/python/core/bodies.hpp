// Bodies of Python, which are objects of the class evodevo.Body, and bodies of the host.
#pragma once

#include <string>
#include <vector>

#include "arrays.hpp"
#include "life/body_building.hpp"
#include "life/body_json.hpp"

namespace evodevo::python {

/// Returns a body of Python as the host needs it. Throws ValueError that begins with `place`, such as "bodies[3]", if
/// its arrays do not fit together or a number is not finite or out of range.
GivenBody body_from(py::handle body, const std::string& place);

/// Returns an unborn body of the host as an evodevo.Body. The first of its materials have names.
py::object body_to_python(const BuiltBody& built, const std::vector<std::string>& material_names);

}  // namespace evodevo::python
