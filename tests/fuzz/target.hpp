// What all targets of fuzzing share.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

namespace evodevo {

/// Gives an input to the code that reads it. Each target defines it. Inputs that are refused are no fault; any other
/// exception ends the program.
void fuzz(std::string_view input);

/// Ends the program if a law does not hold.
inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "fault: %s\n", what);
  std::abort();
}

}  // namespace evodevo
