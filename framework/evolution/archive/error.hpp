// What can be wrong with the folder of a run.
#pragma once

#include <stdexcept>

#include "base/input_error.hpp"

namespace evodevo {

/// A folder that cannot be made, opened, read or is in use, or a record in it that does not fit together. what() names
/// folder, cause and remedy.
struct ArchiveError : InputError {
  using InputError::InputError;
};

/// Storage that fails while it is used, such as a full disk or a file that somebody removes. Likewise.
struct StorageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace evodevo
