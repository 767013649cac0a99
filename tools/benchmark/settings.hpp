// What the command line of the benchmark asks for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/simulator.hpp"

namespace evodevo::benchmark {

inline constexpr double time_step = 0.0005;  ///< s

struct Settings {
  std::string command;  ///< the line itself
  std::string study, device, body, robots, method, precision, instructions, tables;
  std::uint32_t masses = 0, materials = 0, bodies = 0;
  std::uint64_t steps = 0;
  int threads = 0, runs = 0;
  bool json = false;

  Stepping stepping() const;
};

/// Nothing where the line asks for help, which is printed. Throws std::invalid_argument or a boost exception that says
/// what is wrong.
std::optional<Settings> parse(int argc, const char* const* argv);

}  // namespace evodevo::benchmark
