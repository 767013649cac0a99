#include "archive/file_lock.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "archive/error.hpp"

namespace evodevo {

FileLock::FileLock(const std::filesystem::path& file)
    : descriptor_(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
  const std::string folder = file.parent_path().string();
  if (descriptor_ < 0) throw ArchiveError(folder + ": cannot be written; make it writable, or work on a copy of it");
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  if (fcntl(descriptor_, F_OFD_SETLK, &whole) == 0) return;
  const int error = errno;
  ::close(descriptor_);
  if (error == EAGAIN || error == EACCES)
    throw ArchiveError(folder +
                       ": another evodevo process, or this one, is writing this run; wait for it or stop it first");
  throw ArchiveError(folder + ": cannot be locked (" + std::strerror(error) +
                     "); choose a folder on a file system that can lock files");
}

FileLock::~FileLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace evodevo
