// The settings given on the command line of the study.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/program.hpp"

namespace evodevo::tools::stress {

inline constexpr Program program{
    "stress",
#include "stress/help.inc"
};

struct Settings {
  std::string command;  ///< the command line itself
  std::filesystem::path folder;
  std::vector<std::string> experiments;
  std::size_t robots = 0;
  std::string device;
  bool quick = false;
};

/// Returns the options, whose values are stored in `settings`; help.inc describes them.
boost::program_options::options_description options(Settings& settings);

/// Parses the command line. Throws std::invalid_argument or a Boost exception that says what is wrong.
Settings parse(const CommandLine& line);

}  // namespace evodevo::tools::stress
