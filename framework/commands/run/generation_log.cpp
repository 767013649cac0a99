#include "commands/run/generation_log.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <iostream>

#include "base/text.hpp"
#include "commands/shell/command.hpp"
#include "report/run_json.hpp"

namespace evodevo {
GenerationLog::GenerationLog(const std::filesystem::path& file) : file_(file), stream_(file, std::ios::app) {
  if (!stream_)
    throw UsageError("--log " + printable(file.string()) + ": " + std::strerror(errno) +
                     "; give a file in a folder that can be written to");
}

void GenerationLog::add(const Summary& summary, std::int64_t island) {
  if (failed_) return;
  nlohmann::ordered_json line = summary_json(summary);
  if (island > 0) line["island"] = island;
  // a pipe whose reader has ended is an error like any other, and does not end the run
  const auto before = std::signal(SIGPIPE, SIG_IGN);
  stream_ << line.dump() << std::endl;
  const int error = errno;
  failed_ = !stream_;
  if (failed_) stream_.close();  // otherwise its destructor would try to write again
  std::signal(SIGPIPE, before);
  if (!failed_) return;
  std::cerr << "warning: --log " + printable(file_.string()) + ": " + std::strerror(error) +
                   "; it ends with the generation before " + std::to_string(summary.generation) + '\n';
}

}  // namespace evodevo
