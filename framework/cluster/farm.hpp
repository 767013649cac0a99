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
  std::uint64_t robots = 0;  ///< evaluated
  double busy = 0;           ///< time during which it had work, s
  bool lost = false;         ///< whether it has fallen silent
};

/// Returns the number of items in the next job for a rank: less towards the end, so that all ranks end at about the
/// same time, but with so many that it is fast, if there are enough. `left` is the number of items without a job,
/// `jobs` the number of jobs that all ranks do at the same time, and `share` the number of items for each rank if all
/// did the same number. A quarter of the jobs that a rank does at once may be small. At least 1 if any is left.
std::size_t job_size(std::size_t left, std::size_t jobs, std::size_t share, const message::Hello& rank);

/// Tells all other ranks that there is no more work for them. They leave the channel when rank 0 does.
void end_run(Channel& channel);

struct FarmOptions {
  bool mixed = false;                 ///< whether ranks may differ in their devices and builds
  std::chrono::seconds patience{30};  ///< after which a rank that says nothing is given up
};

/// Evaluates and verifies with all ranks of a channel, whose rank is 0. If a rank falls silent, others with the same
/// provenance do its jobs.
/// Experiment, simulator and channel must outlive it.
class Farm final : public Evaluator {
 public:
  /// Sends the setup to the other ranks, and waits until all are ready. Throws std::runtime_error, or InputError if the
  /// cause is bad input, with the rank and its host, if one fails, says nothing for a long time, has operators that
  /// read other genomes or score something else, or, unless ranks are mixed, has another build of the program or of an
  /// operator, or another device. Other functions throw it, too.
  Farm(const Experiment& experiment, Simulator& simulator, Channel& channel, const message::Setup& setup,
       const FarmOptions& options = {});
  std::vector<Provenance> provenances() const override { return provenances_; }
  std::vector<Evaluated> evaluate(std::span<const Newborn> newborns, const Progress& progress) override;
  std::vector<std::vector<LifeRecord>> records(std::span<const Newborn> newborns,
                                               std::span<const std::uint32_t> provenances) override;
  void forget_records() override;
  std::vector<Verification> verify(std::span<const Champion> champions,
                                   std::span<const std::uint32_t> provenances) override;
  std::size_t verified_at_once() const override;
  Workers& workers() override { return worker_.workers(); }
  PhaseTimes phase_times() const override { return worker_.phase_times(); }

  /// What each rank has contributed so far.
  std::vector<Share> shares() const;

 private:
  using Clock = std::chrono::steady_clock;

  struct Rank {
    message::Hello hello;
    std::uint32_t provenance = 0;  ///< index into provenances_
    message::Beat beat;
    Clock::time_point heard;  ///< time of its last message
    std::size_t jobs = 0;     ///< that it has and has not answered
    std::uint64_t robots = 0;
    bool ready = false, lost = false;
  };

  /// The items that are being worked on, and what is known of them.
  struct Batch {
    message::Work work;
    std::vector<message::JobItem> items;
    std::vector<std::uint32_t> needed = {};       ///< for each item, the provenance that a rank must have; empty: any
    std::vector<message::Outcome> outcomes = {};  ///< one for each item
    std::vector<std::uint32_t> found_by = {};     ///< for each item, the provenance of the rank that has answered
    std::vector<std::deque<std::size_t>> left = {};  ///< items in no job, by the provenance that they need; see line()
    std::size_t done = 0;

    /// Returns the index in `left` for a provenance. If items need none, all of them stand in one line.
    std::size_t line(std::uint32_t provenance) const { return needed.empty() ? 0 : provenance; }
    void put_back(std::size_t item) { left[line(needed.empty() ? 0 : needed[item])].push_front(item); }
  };

  /// A job that has not been answered.
  struct Assigned {
    int rank;
    std::vector<std::size_t> items;  ///< indices into the batch
  };

  void wait_for_hellos();
  /// The text by which messages name a rank.
  std::string title(int rank, const std::string& host) const;
  std::string who_is_missing() const;
  void check_questions(int rank, const message::Hello& hello) const;
  void check_equal(int rank, const message::Hello& hello) const;
  std::uint32_t known_provenance(const Provenance& provenance);
  Batch work(Batch batch, const Progress& progress);
  void deal(Batch& batch);
  void deal_to_keepers(Batch& batch);
  std::optional<int> free_rank(const Batch& batch) const;
  std::size_t jobs_at_once(const Batch& batch, std::uint32_t provenance) const;
  std::size_t share_of_rank(const Batch& batch) const;
  void check_served(const Batch& batch) const;
  void assign(int rank, std::vector<std::size_t> items, const Batch& batch);
  bool take_messages(Batch& batch);
  void take(int rank, message::Answer answer, Batch& batch);
  bool beat();
  void give_up_silent(Batch& batch);
  double robots_done(const Batch& batch) const;
  [[noreturn]] void fail(int rank, const message::Failure& failure) const;

  Channel& channel_;
  FarmOptions options_;
  Worker worker_;
  std::vector<Provenance> provenances_;  ///< of all ranks, each once; that of rank 0 first
  std::vector<Rank> ranks_;
  std::map<std::uint64_t, Assigned> jobs_;
  std::map<std::uint32_t, int> keepers_;  ///< of the records that are kept: the rank, by individual
  std::uint64_t next_job_ = 0;
  Clock::time_point next_beat_ = Clock::now(), listened_ = Clock::now();
};

}  // namespace evodevo
