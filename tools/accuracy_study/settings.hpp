// What the command line of the studies asks for.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "simulation.hpp"

namespace evodevo::accuracy {

struct Settings {
  std::string command;  ///< the line itself
  std::filesystem::path folder;
  std::vector<std::string> studies;  ///< by name, in their order
  Device device;
  bool quick = false;
  std::string experiment;  ///< whose random robots are ranked
  std::size_t robots = 0;  ///< how many of them
};

/// Nothing where the line asks for help, which is printed. Throws std::invalid_argument or a boost exception that says
/// what is wrong.
std::optional<Settings> parse(int argc, const char* const* argv);

}  // namespace evodevo::accuracy
