// The errors that the folder of a run can cause.
#pragma once

#include <stdexcept>

#include "base/input_error.hpp"

namespace evodevo {

/// The folder of a run cannot be made, opened or read, or is in use, or the record in it is inconsistent. what() gives
/// the folder, the cause and a remedy.
struct ArchiveError : InputError {
  using InputError::InputError;
};

/// The storage fails while the run's file is in use, for example because the disk is full or because somebody removes
/// the file. what() gives the folder, the cause and a remedy.
struct StorageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace evodevo
