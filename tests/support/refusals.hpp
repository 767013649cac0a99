// What calls say that have to fail or to warn.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>

namespace evodevo::testing {

/// Returns the message of the `Error` that a call throws, or "no refusal".
template <class Error>
std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no refusal";
}

/// Returns what a call writes to standard error.
inline std::string warnings_of(const std::function<void()>& call) {
  ::testing::internal::CaptureStderr();
  call();
  return ::testing::internal::GetCapturedStderr();
}

}  // namespace evodevo::testing
