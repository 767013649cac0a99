// Verifications as commands make and show them.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "archive.hpp"

namespace evodevo {

/// Verifies the `count` best individuals of a run and stores what came out.
std::vector<Verification> verify_best(const Experiment& experiment, Simulator& simulator, Archive& archive,
                                      std::size_t count);

/// "passive", or "verified" where nothing is to be said.
std::string marks_text(const Verification& verification, bool maximise);

void print(const Verification& verification, const Objective& objective);

nlohmann::ordered_json to_json(const Verification& verification, const Objective& objective);

}  // namespace evodevo
