// Verification of individuals before they enter the front, as `[experiment] verify_front` asks.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "archive/population.hpp"
#include "evolution/evaluator.hpp"

namespace evodevo {

/// Verifies individuals and remembers what it found until the process ends. A resumed run verifies the living again and
/// finds the same. Everything that the constructor takes must outlive this object.
class FrontVerification {
 public:
  FrontVerification(const Experiment& experiment, Evaluator& evaluator, const RecordedProvenances& provenances)
      : experiment_(experiment), evaluator_(evaluator), provenances_(provenances) {}

  /// Verifies the individuals on the front of `everyone`. Those that do not hold get the status `artefact`, `lucky` or
  /// `passive` and lose their scores, so that others come to the front, until all that are on it hold. Returns the
  /// refusals, in the order in which they were made; none if the experiment does not ask for verification.
  ///
  /// Copies (copies_in()) are not verified, but they come to the front if the individual that they equal is refused.
  /// Individuals whose provenance the evaluator does not have are not verified, because the new life might differ from
  /// the one that was scored.
  std::vector<Refusal> refuse(std::vector<Individual>& everyone, std::uint32_t generation);

  /// Forgets what was found of individuals that have lived again since, so that they are verified again.
  void forget(std::span<const Individual> individuals);

  /// Wall-clock time spent in refuse(), s.
  double seconds() const { return seconds_; }

 private:
  /// An individual that may come to the front, and its Pareto layer.
  struct Ranked {
    Individual* individual = nullptr;
    std::uint32_t layer = 0;
  };

  std::vector<Ranked> ranked(std::vector<Individual>& everyone, std::uint32_t generation) const;
  void verify_front(const std::vector<Ranked>& line);
  std::optional<Refusal> refusal(const Verification& verification) const;

  const Experiment& experiment_;
  Evaluator& evaluator_;
  const RecordedProvenances& provenances_;
  std::map<std::uint32_t, std::optional<Refusal>> verified_;  ///< by id; nullopt: it holds
  double seconds_ = 0;
};

}  // namespace evodevo
