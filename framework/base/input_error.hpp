// Errors that end a command because its input cannot be used.
#pragma once

#include <stdexcept>
#include <string>

#include "base/text.hpp"

namespace evodevo {

/// Bad input on a command line, in a file or in a folder. The command ends with exit code 2. what() is the complete
/// message, on one line: it gives the place, the value and a remedy.
struct InputError : std::runtime_error {
  explicit InputError(const std::string& message) : std::runtime_error(printable(message, longest_message)) {}

  static constexpr std::size_t longest_message = 4000;  ///< greatest length of what(), bytes
};

/// An error in a command-line option, or in a file that the user has written.
struct ConfigError : InputError {
  using InputError::InputError;
};

}  // namespace evodevo
