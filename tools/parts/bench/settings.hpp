// The settings given on the command line of the benchmark.
#pragma once

#include <cstdint>
#include <string>

#include "common/program.hpp"
#include "core/simulator.hpp"

namespace evodevo::tools::bench {

inline constexpr Program program{
    "bench",
#include "bench/help.inc"
};

struct Settings {
  std::string command;  ///< the command line itself
  std::string study, device, body, robots, method, precision, instructions, tables;
  std::uint32_t masses = 0, materials = 0, bodies = 0;
  std::uint64_t steps = 0;
  int threads = 0, runs = 0;
  bool json = false;

  Stepping stepping() const;
};

/// Returns the options, whose values are stored in `settings`; help.inc describes them.
boost::program_options::options_description options(Settings& settings);

/// Parses the command line. Throws std::invalid_argument or a Boost exception that says what is wrong.
Settings parse(const CommandLine& line);

}  // namespace evodevo::tools::bench
