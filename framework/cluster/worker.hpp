// The work of one rank.
//
//   Job ─► start ─► a thread of its own: LocalEvaluator ─► answer ─► Answer
#pragma once

#include <chrono>
#include <condition_variable>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "cluster/channel.hpp"
#include "cluster/messages.hpp"
#include "threads/busy_clock.hpp"

namespace evodevo {

/// Does jobs, several at the same time. Experiment and simulator must outlive it.
class Worker {
 public:
  Worker(const Experiment& experiment, Simulator& simulator);
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
  /// Waits for unfinished jobs.
  ~Worker();

  /// What this rank is. `hello.jobs` jobs of `hello.robots` robots keep its device busy.
  const message::Hello& hello() const { return hello_; }

  void start(message::Job job);
  /// Returns the answer to a job that has ended, if there is any. Throws what the job has thrown.
  std::optional<message::Answer> answer();
  /// Waits until there is an answer, but at most for `time`.
  void wait(std::chrono::microseconds time);

  void forget_records() { evaluator_.forget_records(); }
  message::Beat beat() const;
  Workers& workers() { return evaluator_.workers(); }
  PhaseTimes phase_times() const { return evaluator_.phase_times(); }

 private:
  struct Done {
    message::Answer answer;
    std::exception_ptr failure;
  };

  void work(const message::Job& job);
  std::vector<message::Outcome> outcomes(const message::Job& job);
  std::vector<Evaluated> evaluated(std::span<const Newborn> newborns, std::uint64_t job);

  message::Hello hello_;
  LocalEvaluator evaluator_;
  mutable BusyClock busy_;
  mutable std::mutex mutex_;
  std::condition_variable job_ended_;
  std::map<std::uint64_t, double> progress_;  ///< of unfinished evaluations, by job: number of robots
  std::vector<Done> done_;
  std::map<std::uint64_t, std::jthread> threads_;  ///< by job
};

/// How long a rank waits for a word of rank 0, which says nothing while it breeds, selects and writes.
constexpr std::chrono::seconds patience_with_leader = std::chrono::minutes(10);

/// Does the jobs that rank 0 sends until it ends the run. If a job fails, tells rank 0, and waits until it ends the
/// run. Throws std::runtime_error if rank 0 has said nothing for `patience`.
void do_jobs(Channel& channel, Worker& worker, std::chrono::seconds patience = patience_with_leader);

/// What the command line of a rank says about it.
struct RankOptions {
  std::vector<std::filesystem::path> plugin_path;  ///< is searched for operators
  std::vector<int> gpus;                           ///< Experiment::gpus
  std::vector<Override> overrides;                 ///< of the experiment that rank 0 sends: its device and threads
  bool mixed = false;                              ///< see share_host()
};

/// Throws InputError if a Setup or Lead is of a rank 0 that speaks another protocol.
void require_protocol(const std::string& bytes);

/// The name of this host, for messages.
std::string host_name();

/// Waits for the message with which rank 0 begins: Setup, or Lead if the run has islands. Returns nullopt if it ends
/// the run instead. Throws like do_jobs().
std::optional<std::string> first_message(Channel& channel);

/// Tells rank 0 why this rank cannot go on, and waits until it ends the run. If this process ended sooner, the launcher
/// could end rank 0 before it has said so to the user.
void report_failure(const std::exception& error, Channel& channel,
                    std::chrono::seconds patience = patience_with_leader);

/// Does the whole work of a rank other than 0, given the Setup that it has got: makes the experiment that rank 0 sends,
/// introduces itself and does jobs. If it cannot, tells rank 0, which says so to the user. Throws like do_jobs().
void serve(Channel& channel, const std::string& setup, const std::function<RankOptions()>& options);

}  // namespace evodevo
