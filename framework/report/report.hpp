// The data of the pages that the commands report, gallery and film make.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "archive/archive.hpp"

namespace evodevo {

/// Largest total size of the films of all robots on a page, bytes. It keeps the page under 30 MB.
inline constexpr std::size_t page_budget = 27'000'000;

/// The robots of a run that a page shows.
struct Cast {
  std::size_t best = 3;                    ///< number of best individuals by the first objective
  std::size_t best_of_others = 1;          ///< number of best individuals by each further objective
  std::size_t ancestors = 3;               ///< number of ancestors of the best individual, evenly spaced, founder first
  std::size_t elites = 0;                  ///< number of best individuals of niches, if the run has any
  std::vector<std::uint32_t> individuals;  ///< ids of further individuals, which are in the archive
  std::optional<std::int64_t>
      life;  ///< the only life to show; if not given, as many as newborns have, but of elites one
};

/// Returns the data of a run for a report: numbers of the run, its population, and the robots of `cast` with films.
/// `simulator` simulates the robots again (evolution/resimulation.hpp), each life of a robot being one of the page's.
/// `budget` is the largest total size of the films, bytes. If the experiment has scenarios, the films end in the first
/// repeat of the one with index `scenario`, whose ground they show.
nlohmann::ordered_json reported_run(const Archive& archive, const Experiment& experiment, Simulator& simulator,
                                    const Cast& cast, std::size_t budget, std::size_t scenario = 0);

/// Returns the data of a page that shows runs.
nlohmann::ordered_json report_data(std::vector<nlohmann::ordered_json> runs);

/// Returns the data of a page that shows `count` random robots of an experiment: for each robot, how the encoding maps
/// points to positions, and the body.
nlohmann::ordered_json gallery_data(const Experiment& experiment, std::size_t count);

}  // namespace evodevo
