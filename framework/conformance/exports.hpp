// The symbols that a shared library offers to others.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace evodevo::conformance {

/// The defined symbols of the ELF file's dynamic table, sorted, but for those of the standard library's templates.
/// Throws std::runtime_error where it is no such file.
std::vector<std::string> exports(const std::filesystem::path& library);

}  // namespace evodevo::conformance
