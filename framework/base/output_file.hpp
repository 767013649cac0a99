// What is written is checked: files and the standard output.
#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace evodevo {

/// A file that is written as a whole. Text goes to a file beside it, NAME.unfinished-PID, which finish() renames, so
/// that nobody takes a part for the whole, and what was there before stays where writing fails. Pipes, devices, what
/// lies under /dev or /proc, and files in folders that take no new ones are written in place. A link is followed.
/// Every call throws std::runtime_error that names `title` and the cause where something cannot be written.
class OutputFile {
 public:
  /// `title` is what messages call the file, such as "--out page.html".
  OutputFile(const std::filesystem::path& file, std::string title);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();  ///< leaves no unfinished file behind

  void write(std::string_view text);
  /// Closes the file and gives it its name.
  void finish();

 private:
  void open_beside(const std::filesystem::path& file);
  [[noreturn]] void fail(int error) const;

  std::string title_;
  std::filesystem::path target_, beside_;  ///< `beside_` is empty where the file is written in place
  std::FILE* stream_ = nullptr;
};

/// Writes `text` as the whole of `file`. Throws like OutputFile.
void write_file(const std::filesystem::path& file, std::string_view text);

/// Throws std::runtime_error with the cause where something that was printed, through std::cout or stdio, has been
/// lost. To be called at the end of a program.
void finish_standard_output();

}  // namespace evodevo
