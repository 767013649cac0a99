// The generation loop.
#pragma once

#include <atomic>
#include <functional>
#include <memory>

#include "archive/archive.hpp"
#include "archive/progress.hpp"
#include "evolution/evaluator.hpp"

namespace evodevo {

class Migration;

/// Functions that the generation loop calls to report its progress.
struct Observer {
  /// Called after each generation, which may still be being written into the archive (ArchiveWriter), with the number
  /// of its island, from 1, or 0 if the run has no islands.
  std::function<void(std::int64_t island, const Summary&)> generation_done = [](std::int64_t, const Summary&) {};
  /// Called with the fraction of the current generation that has been simulated, 0 to 1.
  std::function<void(double)> generation_progress = [](double) {};
};

/// The generation loop of the run in an archive, one generation at a time. A run that was interrupted after any
/// generation and continued gives the same results as one that was not interrupted. With a migration, the experiment is
/// that of one island, and advance() waits until the islands from which migrants come have made the generation before.
/// Everything that the constructor is given must outlive the object; until pause(), nobody else may use the archive.
/// After a function has thrown, only pause() may be called.
class Evolution {
 public:
  Evolution(const Experiment& experiment, Evaluator& evaluator, Archive& archive, Migration* migration = nullptr);
  Evolution(Evolution&&) noexcept;
  ~Evolution();

  /// Whether the run has used up what the experiment allows.
  bool is_finished() const;
  /// The number of the next generation.
  std::uint32_t generation() const;
  /// Makes the next generation and commits it, or begins to (ArchiveWriter). Returns false, and makes none, if the run
  /// is finished, or if `stop` is set, also while it waits for migrants; a generation that has begun is completed.
  bool advance(const std::atomic<bool>& stop, const Observer& observer = {});
  /// Waits until all generations have been committed, and returns the time that has been spent so far.
  TimeSpent pause();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Continues the run in the archive until the run is finished or `stop` is set.
TimeSpent evolve(const Experiment& experiment, Evaluator& evaluator, Archive& archive, const std::atomic<bool>& stop,
                 const Observer& observer);
/// Does the same in this process alone.
TimeSpent evolve(const Experiment& experiment, Simulator& simulator, Archive& archive, const std::atomic<bool>& stop,
                 const Observer& observer);

}  // namespace evodevo
