// The settings given on the command line of the studies.
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
  std::string command;  ///< the command line itself
  std::filesystem::path folder;
  std::vector<std::string> studies;  ///< names of the studies, in the order in which they run
  Device device;
  bool quick = false;
  std::string experiment;  ///< experiment file whose random robots are ranked
  std::size_t robots = 0;  ///< number of these robots
};

/// Returns the options, whose values are stored in `settings`; help.inc describes them.
boost::program_options::options_description options(Settings& settings);

/// Parses the command line. Throws std::invalid_argument or a Boost exception that says what is wrong.
Settings parse(const CommandLine& line);

}  // namespace evodevo::tools::accuracy
