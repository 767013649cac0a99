// What the pages of report, gallery and film hold.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "evolution/archive/archive.hpp"

namespace evodevo {

/// Bytes that the films of all robots of a page may take together, so that it stays under 30 MB.
inline constexpr std::size_t page_budget = 27'000'000;

/// Which robots of a run are shown.
struct Cast {
  std::size_t best = 3;                    ///< champions, by the first objective
  std::size_t ancestors = 3;               ///< of the best one, spread over its line, the founder first
  std::vector<std::uint32_t> individuals;  ///< these as well; all are in the archive
};

/// A run as a report shows it: its numbers, its population, and its cast simulated again on `simulator`; see
/// living_again.hpp. `budget` is for its robots' films.
nlohmann::ordered_json reported_run(const Archive& archive, const Experiment& experiment, Simulator& simulator,
                                    const Cast& cast, std::size_t budget);

/// A page of runs.
nlohmann::ordered_json report_data(std::vector<nlohmann::ordered_json> runs);

/// A page of `count` random robots of an experiment: how each one's points become positions, and its body.
nlohmann::ordered_json gallery_data(const Experiment& experiment, std::size_t count);

}  // namespace evodevo
