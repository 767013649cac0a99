// A run in numbers, as JSON: what `show --json` prints and a report's page holds.
#pragma once

#include <nlohmann/json.hpp>

#include "evolution/archive/archive.hpp"

namespace evodevo {

/// How many of all newborns were clones.
std::int64_t clones(const std::vector<Summary>& generations);

/// An individual and its first parents, back to the random individual that it comes from.
std::vector<ArchivedIndividual> ancestry(const Archive& archive, std::uint32_t id);

/// The age of its oldest genes when it was last in the population, generations.
std::uint32_t last_age(const ArchivedIndividual& individual, std::uint32_t last_generation);

/// An individual with its objectives, parents, ancestors and verification. One without fitness has no objectives.
nlohmann::ordered_json individual_json(const Archive& archive, const ArchivedIndividual& individual);

/// A verification with its marks and trials.
nlohmann::ordered_json verification_json(const Verification& verification, const Objective& objective);

/// The whole run: where from, how far, every generation, and the best individual.
nlohmann::ordered_json run_json(const Archive& archive, const Settings& settings);

}  // namespace evodevo
