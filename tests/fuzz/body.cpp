// A body in JSON.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/input_error.hpp"
#include "fuzz/target.hpp"
#include "life/body_json.hpp"

namespace evodevo {
namespace {

/// A file in memory.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view text) : descriptor_(memfd_create("body", 0)) {
    require(descriptor_ >= 0 && write(descriptor_, text.data(), text.size()) == static_cast<ssize_t>(text.size()),
            "no file in memory");
  }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

GivenBody body_in(std::string_view text) { return read_body(MemoryFile(text).path()); }

}  // namespace

void fuzz(std::string_view input) {
  try {
    const GivenBody given = body_in(input);
    const std::vector<std::string> names(given.body.materials.size(), "material");
    const std::string text = body_to_json(given, names);
    require(body_to_json(body_in(text), names) == text, "a body that was written reads back as another one");
  } catch (const ConfigError&) {
  }
}

}  // namespace evodevo
