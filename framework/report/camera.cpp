#include "report/camera.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <vector>

#include "base/text.hpp"
#include "report/page.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

/// A temporary folder. The destructor removes it with its content.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "evodevo-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw std::runtime_error(name + ": no temporary folder can be created: " + std::strerror(errno));
    path_ = name;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Runs a program from the search path, waits for its end, and returns its exit code.
int run_program(std::vector<std::string> words) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t process = 0;
  if (const int error = posix_spawnp(&process, arguments[0], nullptr, nullptr, arguments.data(), environ); error != 0)
    throw std::runtime_error(
        words[0] + ": cannot be started: " + std::strerror(error) +
        "; films need Node.js, Chromium and ffmpeg (Debian: apt-get install nodejs chromium ffmpeg)");
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

std::string content_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw std::runtime_error(file.string() + ": cannot be read: " + std::strerror(errno));
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

void shoot(const std::string& page, OutputFile& output, const fs::path& file, const Shooting& shooting) {
  const TemporaryFolder folder;
  const fs::path html = folder.path() / "page.html", film = folder.path() / ("film" + file.extension().string());
  write_file(html, page);
  std::vector<std::string> words = {"node", (viewer_folder() / "film.mjs").string(), html.string(), film.string(),
                                    file.string()};
  const auto add = [&](const char* option, const std::optional<double>& time) {
    if (time) words.insert(words.end(), {option, to_text(*time)});
  };
  add("--at", shooting.at);
  add("--from", shooting.from);
  add("--to", shooting.to);
  if (shooting.quiet) words.emplace_back("--quiet");
  if (run_program(std::move(words)) != 0) throw std::runtime_error(file.string() + ": has not been written");
  output.write(content_of(film));
  output.finish();
}

}  // namespace evodevo
