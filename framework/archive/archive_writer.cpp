#include "archive/archive_writer.hpp"

#include <chrono>
#include <memory>
#include <system_error>
#include <utility>

namespace evodevo {
namespace {

/// Whether the next generation should not wait for a commit of `commit` seconds after a generation of `generation`.
bool is_long(double commit, double generation) { return commit > 0.1 && commit > 0.1 * generation; }

}  // namespace

void ArchiveWriter::begin(FinishedGeneration generation) {
  wait();
  const auto when = is_long(last_, generation.summary.wall_time) ? std::launch::async : std::launch::deferred;
  const auto finished = std::make_shared<const FinishedGeneration>(std::move(generation));
  const auto commit = [&archive = archive_, finished] {
    const auto start = std::chrono::steady_clock::now();
    archive.commit(*finished);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  try {
    under_way_ = std::async(when, commit);
  } catch (const std::system_error&) {  // the system grants no more threads
    under_way_ = std::async(std::launch::deferred, commit);
  }
  if (under_way_.wait_for(std::chrono::seconds(0)) == std::future_status::deferred) wait();
}

void ArchiveWriter::wait() {
  if (!under_way_.valid()) return;
  last_ = under_way_.get();
  seconds_ += last_;
}

}  // namespace evodevo
