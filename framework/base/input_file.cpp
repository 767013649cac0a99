#include "base/input_file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "base/input_error.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& file, const std::string& reason) {
  throw ConfigError((file.empty() ? "\"\"" : printable(file, longest_shown_path)) + ": cannot be read: " + reason);
}

}  // namespace

std::string read_input_file(const std::string& file, std::size_t most) {
  std::error_code error;
  if (fs::is_directory(file, error)) refuse(file, "it is a folder; give a file");
  // Opening a named pipe would block until another process opens it for writing. A pipe that a shell makes has a writer
  // already; it has no canonical path and is therefore not refused here.
  if (const fs::path path = fs::canonical(file, error); !error && fs::is_fifo(path, error))
    refuse(file, "it is a named pipe; give a file, or /dev/stdin");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) refuse(file, std::strerror(errno));
  std::string text;
  std::array<char, 65536> buffer;
  while (text.size() <= most && stream) {
    stream.read(buffer.data(), static_cast<std::streamsize>(std::min(buffer.size(), most + 1 - text.size())));
    text.append(buffer.data(), static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad()) refuse(file, std::strerror(errno));
  if (text.size() > most) refuse(file, "it holds more than " + std::to_string(most) + " bytes; give a smaller file");
  return text;
}

}  // namespace evodevo
