// Writing to files and to standard output, with every error checked.
#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace evodevo {

struct Unfinished;

/// A file that is written completely or not at all. The text is written to the temporary file NAME.unfinished-PID in
/// the same folder, and finish() renames this file. Thus an incomplete text is never mistaken for a complete one, and
/// an earlier file of this name survives if writing fails. Pipes, devices, paths under /dev or /proc, and files in
/// folders where no file can be created are written in place. Symbolic links are followed. If a signal ends the process
/// meanwhile, the temporary file is removed and a message says so. Every function throws a std::runtime_error that
/// names `title` and the cause if the file cannot be written.
class OutputFile {
 public:
  /// `title` is the name of the file in messages, such as "--out page.html".
  OutputFile(const std::filesystem::path& file, std::string title);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();  ///< removes the temporary file if finish() was not called

  void write(std::string_view text);
  /// Closes the temporary file and renames it to the final name.
  void finish();

 private:
  void open_beside(const std::filesystem::path& file);
  void remove_beside();
  [[noreturn]] void fail(int error) const;

  std::string title_;
  std::filesystem::path target_, beside_;  ///< `beside_`: temporary file; empty if the target is written in place
  std::FILE* stream_ = nullptr;
  Unfinished* noted_ = nullptr;  ///< where signal handlers find the temporary file
};

/// Removes the temporary files of this process and says for each that its file is not written. Signal handlers that end
/// the process call it.
void leave_no_unfinished_files();

/// Writes `text` as the complete content of `file`. Throws like OutputFile.
void write_file(const std::filesystem::path& file, std::string_view text);

/// Flushes standard output. Throws std::runtime_error with the cause if anything printed through std::cout or stdio has
/// been lost. To be called at the end of a program.
void finish_standard_output();

}  // namespace evodevo
