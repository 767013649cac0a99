// The ranks of a run at work for rank 0.
//
//   items ─► jobs, as ranks get free ─► Worker of rank 0, or Channel ─► Workers of the others ─► outcomes, in order
#pragma once

#include <chrono>
#include <deque>
#include <map>
#include <vector>

#include "cluster/worker.hpp"

namespace evodevo {

/// What a rank has contributed to a run.
struct Share {
  int rank = 0;
  std::string host;
  std::uint64_t lives = 0;  ///< evaluated
  double busy = 0;          ///< time during which it had work, s
  bool lost = false;        ///< whether it has fallen silent
};

/// Returns the number of items in the next job for a rank: what it is fast with, and less towards the end, so that all
/// ranks end at about the same time. `left` is the number of items without a job, `jobs` the number of jobs that all
/// ranks do at the same time, and `fast` is Hello::lives. At least 1 if any is left.
std::size_t job_size(std::size_t left, std::size_t jobs, std::size_t fast);

/// Tells all other ranks that there is no more work for them. They leave the channel when rank 0 does.
void end_run(Channel& channel);

/// Evaluates and verifies with all ranks of a channel, whose rank is 0. If a rank falls silent, others do its jobs.
/// Experiment, simulator and channel must outlive it.
class Farm final : public Evaluator {
 public:
  /// Sends the setup to the other ranks, and waits until all are ready. Throws std::runtime_error, or InputError if the
  /// cause is bad input, with the rank and its host, if one fails, if it has another build of the program or of an
  /// operator, or another device, or if it says nothing for `patience`; other functions throw it, too.
  Farm(const Experiment& experiment, Simulator& simulator, Channel& channel, const message::Setup& setup,
       std::chrono::seconds patience = std::chrono::seconds(30));
  std::vector<Result> evaluate(std::span<const Newborn> newborns, const Progress& progress) override;
  std::vector<LifeRecord> records(std::span<const Newborn> newborns) override;
  void forget_records() override;
  std::vector<Verification> verify(std::span<const Champion> champions) override;
  std::size_t verified_at_once() const override;
  std::string device() const override { return worker_.hello().provenance.device; }
  PhaseTimes phase_times() const override { return worker_.phase_times(); }

  /// Ends the run for the other ranks, so that they do not wait for work while this one goes on alone.
  void finish() { end_run(channel_); }
  /// What each rank has contributed so far.
  std::vector<Share> shares() const;

 private:
  using Clock = std::chrono::steady_clock;

  struct Rank {
    message::Hello hello;
    message::Beat beat;
    Clock::time_point heard;  ///< time of its last message
    std::size_t jobs = 0;     ///< that it has and has not answered
    std::uint64_t lives = 0;
    bool ready = false, lost = false;
  };

  /// The items that are being worked on, and what is known of them.
  struct Batch {
    message::Work work;
    std::vector<message::JobItem> items;
    std::vector<message::Outcome> outcomes;
    std::deque<std::size_t> left;  ///< indices of the items that are in no job
    std::size_t done = 0;
  };

  /// A job that has not been answered.
  struct Assigned {
    int rank;
    std::vector<std::size_t> items;  ///< indices into the batch
  };

  void wait_for_hellos();
  std::string who_is_missing() const;
  void check_program(int rank, const message::Hello& sender) const;
  void check(int rank, const message::Hello& hello) const;
  std::vector<message::Outcome> work(message::Work work, std::vector<message::JobItem> items, const Progress& progress);
  void deal(Batch& batch);
  void deal_to_keepers(Batch& batch);
  std::optional<int> free_rank() const;
  void assign(int rank, std::vector<std::size_t> items, const Batch& batch);
  bool take_messages(Batch& batch);
  void take(int rank, message::Answer answer, Batch& batch);
  bool beat();
  void give_up_silent(Batch& batch);
  double lives_done(const Batch& batch) const;
  [[noreturn]] void fail(int rank, const message::Failure& failure) const;

  Channel& channel_;
  std::chrono::seconds patience_;
  Worker worker_;
  std::vector<Rank> ranks_;
  std::map<std::uint64_t, Assigned> jobs_;
  std::map<std::uint32_t, int> keepers_;  ///< of the records that are kept: the rank, by individual
  std::uint64_t next_job_ = 0;
  Clock::time_point next_beat_ = Clock::now(), listened_ = Clock::now();
};

}  // namespace evodevo
