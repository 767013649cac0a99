// The program `evodevo`, as a user calls it.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "support/process.hpp"

namespace evodevo::testing {

using Words = std::vector<std::string>;

inline Words joined(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// Returns the options that give values to keys of an experiment.
inline Words setting(const Words& values) {
  Words options;
  for (const std::string& value : values) options.insert(options.end(), {"--set", value});
  return options;
}

inline Words program(const Words& words) { return joined({EVODEVO_PROGRAM}, words); }

inline Finished evodevo(const Words& words) { return run(program(words)); }

/// Runs a command to its end, expects the exit code, and returns the output.
inline std::string output_of(const Words& command, int exit_code = 0) {
  const Finished finished = run(command);
  EXPECT_EQ(finished.exit_code, exit_code) << ::testing::PrintToString(command) << '\n' << finished.output;
  return finished.output;
}

/// What the program prints if it succeeds.
inline std::string said(const Words& words) { return output_of(program(words)); }

/// What the program prints if it refuses what it was told.
inline std::string refusal(const Words& words) { return output_of(program(words), 2); }

}  // namespace evodevo::testing
