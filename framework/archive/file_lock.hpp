// The lock by which one run at a time writes to a folder.
#pragma once

#include <filesystem>
#include <utility>

namespace evodevo {

/// Holds a lock on a file as long as it exists. Unlike locks of POSIX, which belong to a process, it also excludes
/// other locks in this process, and no other use of the file ends it (open file description locks). A child that was
/// forked meanwhile holds it, too, until it ends.
class FileLock {
 public:
  /// Creates the file if there is none. Throws ArchiveError, which names the folder of the file, if it cannot be
  /// written or locked, or if there is such a lock already.
  explicit FileLock(const std::filesystem::path& file);
  FileLock(FileLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  FileLock& operator=(FileLock&&) = delete;
  ~FileLock();

 private:
  int descriptor_;
};

}  // namespace evodevo
