// What the command line of the studies asks for.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/program.hpp"
#include "simulation.hpp"

namespace evodevo::tools::accuracy {

inline constexpr Program program{
    "accuracy",
#include "accuracy/help.inc"
};

struct Settings {
  std::string command;  ///< the line itself
  std::filesystem::path folder;
  std::vector<std::string> studies;  ///< by name, in their order
  Device device;
  bool quick = false;
  std::string experiment;  ///< whose random robots are ranked
  std::size_t robots = 0;  ///< how many of them
};

/// The options and where their values go; help.inc describes them.
boost::program_options::options_description options(Settings& settings);

/// Throws std::invalid_argument or a boost exception that says what is wrong.
Settings parse(const CommandLine& line);

}  // namespace evodevo::tools::accuracy
