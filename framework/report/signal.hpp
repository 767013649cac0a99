// What the numbers of a signal mean, in sentences and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "archive/archive.hpp"
#include "experiment/experiment.hpp"

namespace evodevo {

/// Returns a sentence or two on each thing that was measured, with what would help: more lives, another measure,
/// smaller or larger mutations. They are about the last population if it was measured, and otherwise about random
/// robots. With a repeatability r of one life, 4 (1 - r)/r lives have a mean of repeatability 0.8 (Spearman and Brown
/// 1910).
std::vector<std::string> sentences_on(const std::vector<SignalNumber>& numbers, const Settings& settings,
                                      const Objective& objective);

/// Returns the numbers and the sentences.
nlohmann::ordered_json signal_json(const std::vector<SignalNumber>& numbers, const Settings& settings,
                                   const Objective& objective);

}  // namespace evodevo
