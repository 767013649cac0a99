// The symbols that a shared library offers to others.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace evodevo::conformance {

/// The defined strong symbols of the ELF file's dynamic table, sorted. Weak ones, which templates of the standard
/// library become, are left out: the host opens libraries so that they do not see each other's.
std::vector<std::string> exports(const std::filesystem::path& library);

}  // namespace evodevo::conformance
