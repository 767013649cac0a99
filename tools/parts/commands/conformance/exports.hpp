// The symbols that a shared library exports.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace evodevo::conformance {

/// Returns the names of the exported symbols of an ELF file, sorted, without those of the standard library's templates.
/// Throws std::runtime_error if the file is not an ELF file.
std::vector<std::string> exports(const std::filesystem::path& library);

}  // namespace evodevo::conformance
