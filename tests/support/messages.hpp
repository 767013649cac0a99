// Matchers for messages to users. Tests check that a message contains the place, the value and the remedy, but do not
// check its wording.
#pragma once

#include <gmock/gmock.h>

#include <string>

namespace evodevo::testing {

/// Matches a text that contains each of `parts`, such as a file, a key, a value, or the option to give.
template <class... Parts>
auto naming(const Parts&... parts) {
  return ::testing::AllOf(::testing::HasSubstr(parts)...);
}

/// Matches a message that begins with `place`, such as "file:line:column: key = value: ", and contains each of `parts`.
template <class... Parts>
auto at_place(const std::string& place, const Parts&... parts) {
  return ::testing::AllOf(::testing::StartsWith(place), ::testing::HasSubstr(parts)...);
}

}  // namespace evodevo::testing
