// The numbers of a run as JSON, for `show --json` and for the page of a report.
#pragma once

#include <nlohmann/json.hpp>

#include "archive/archive.hpp"
#include "base/statistics.hpp"

namespace evodevo {

/// Returns the summary of a generation.
nlohmann::ordered_json summary_json(const Summary& summary);

/// Returns the number of clones in all generations.
std::int64_t clones(const std::vector<Summary>& generations);

/// Returns an individual's age, in generations, when it was dropped, or in the last generation if it is still alive.
std::uint32_t last_age(const ArchivedIndividual& individual, std::uint32_t last_generation);

/// Returns the best score and the median in an objective, given by its index, in each generation, over the survivors
/// whose status is `ok`.
std::vector<BestAndMedian> progress_in(const Archive& archive, const std::vector<Summary>& generations,
                                       std::size_t objective);

/// An individual that was better in the first objective than all before it, and the best of its generation in it.
struct BestSoFar {
  std::uint32_t individual = 0, born = 0;
  double value = 0;
};
/// Returns the best so far of each generation in which the best changed, in the order of birth.
std::vector<BestSoFar> best_over_generations(const Archive& archive);

/// Returns the scores of objectives by their names; none if there are no scores.
nlohmann::ordered_json objectives_json(const std::vector<Objective>& objectives, const std::vector<double>& scores);
/// Returns the scores of an individual that are not objectives, by their names.
nlohmann::ordered_json measures_json(const Archive& archive, std::uint32_t id);

/// Returns an individual with its objectives, parents, ancestors, the blocks that came and went on the way, and its
/// verification. If it has no fitness, the JSON has
/// no objectives.
nlohmann::ordered_json individual_json(const Archive& archive, const ArchivedIndividual& individual);

/// Returns a verification with its marks and trials.
nlohmann::ordered_json verification_json(const Verification& verification, const Objective& objective);

/// Returns the whole run: its origin, its progress, all generations, and the best individual.
nlohmann::ordered_json run_json(const Archive& archive, const Settings& settings);

}  // namespace evodevo
