#include "base/standard_streams.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <utility>

namespace evodevo {

void open_standard_streams() {
  // a new file gets the lowest number that is free, so that none below it may be; nobody can write to what is open for
  // reading
  for (const auto& [stream, mode] :
       {std::pair{STDIN_FILENO, O_RDONLY}, {STDOUT_FILENO, O_RDONLY}, {STDERR_FILENO, O_WRONLY}})
    if (fcntl(stream, F_GETFD) < 0) open("/dev/null", mode);
}

}  // namespace evodevo
