// The records of lives that an archive keeps.
#pragma once

#include <map>
#include <vector>

#include "archive/archive.hpp"
#include "evolution/evaluator.hpp"

namespace evodevo {

/// Decides which records of lives the archive keeps: those of all individuals that are ever on the front. What it is
/// given must outlive it.
class FrontLives {
 public:
  FrontLives(const Experiment& experiment, Evaluator& evaluator, const RecordedProvenances& provenances,
             const Archive& archive);

  /// Keeps the records of all lives of the individuals on the front. A few older individuals reach the front only now,
  /// because selection has removed the individuals that dominated them. Their records no longer exist, so they are
  /// simulated again. Individuals whose provenance the evaluator does not have are not simulated again, because the new
  /// life might differ from the one that was scored.
  void keep_front(const std::vector<Individual>& everyone, std::uint32_t generation);
  /// Returns the records that the current generation adds to the archive, and forgets all of its records.
  LivesById committed();

 private:
  const Experiment& experiment_;
  Evaluator& evaluator_;
  const RecordedProvenances& provenances_;
  LivesById to_commit_;
  std::map<std::uint32_t, std::uint32_t> kept_;  ///< number of lives whose records are kept, by id
};

}  // namespace evodevo
