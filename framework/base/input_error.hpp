// What ends a command that was given something it cannot use.
#pragma once

#include <stdexcept>
#include <string>

#include "base/text.hpp"

namespace evodevo {

/// Bad input: a command line, a file or a folder. The command ends with exit code 2. what() is the whole message, on
/// one line: place, value, remedy.
struct InputError : std::runtime_error {
  explicit InputError(const std::string& message) : std::runtime_error(printable(message, longest_message)) {}

  static constexpr std::size_t longest_message = 4000;  ///< bytes
};

/// A file that people write, or an option, that cannot be used as it is written.
struct ConfigError : InputError {
  using InputError::InputError;
};

}  // namespace evodevo
