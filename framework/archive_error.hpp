// What can be wrong with the folder of a run.
#pragma once

#include <stdexcept>
#include <string>

namespace evodevo {

/// `text` without the control characters that something read from a file may bring along.
inline std::string on_one_line(std::string text) {
  for (char& letter : text)
    if (static_cast<unsigned char>(letter) < ' ' || letter == '\x7f') letter = ' ';
  return text;
}

/// A folder that cannot be made, opened, read or is in use, or a record in it that does not fit together. what() names
/// folder, cause and remedy.
struct ArchiveError : std::runtime_error {
  explicit ArchiveError(const std::string& message) : std::runtime_error(on_one_line(message)) {}
};

/// Storage that fails while it is used, such as a full disk or a file that somebody removes. Likewise.
struct StorageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace evodevo
