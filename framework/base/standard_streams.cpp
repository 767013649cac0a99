#include "base/standard_streams.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <utility>

namespace evodevo {

void open_standard_streams() {
  // In ascending order, because open() returns the lowest free descriptor. Standard output is opened for reading only,
  // so that writing to it fails.
  for (const auto& [stream, mode] :
       {std::pair{STDIN_FILENO, O_RDONLY}, {STDOUT_FILENO, O_RDONLY}, {STDERR_FILENO, O_WRONLY}})
    if (fcntl(stream, F_GETFD) < 0) open("/dev/null", mode);
}

}  // namespace evodevo
