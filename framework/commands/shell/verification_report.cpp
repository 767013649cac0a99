#include "commands/shell/verification_report.hpp"

#include <fmt/ostream.h>

#include <iostream>

#include "base/text.hpp"
#include "commands/shell/options.hpp"
#include "commands/shell/output/notices.hpp"
#include "evolution/resimulation.hpp"

namespace evodevo {
namespace {

std::string number(const std::optional<double>& value) { return value ? short_number(*value) : "-"; }

std::vector<ArchivedIndividual> best_of(const Archive& archive, std::size_t count) {
  std::vector<ArchivedIndividual> individuals;
  for (const std::uint32_t id : archive.best(count)) individuals.push_back(archive.known_individual(id));
  return individuals;
}

void print(const Verification& verification, const Objective& objective) {
  fmt::print(std::cout, "individual {}: {} {}: {}\n", verification.individual, objective.name,
             short_quantity(verification.fitness, objective.unit), verdict_text(verification, objective.maximise));
  for (const Trial& trial : verification.trials) {
    const bool has_held = held(verification, trial, objective.maximise);
    const char* outcome = has_held ? "held" : trial.name == "no-muscles" ? "not held, as it should be" : "not held";
    fmt::print(std::cout, "  {:<14} {:>10}  {}", trial.name, number(trial.value), outcome);
    if (!trial.reason.empty()) std::cout << ", " << name(trial.status) << ": " << trial.reason;
    std::cout << '\n';
  }
}

}  // namespace

std::vector<Verification> verify_life_of_best(const Experiment& experiment, Simulator& simulator,
                                              const Archive& archive, std::size_t count, std::int64_t life) {
  const std::vector<ArchivedIndividual> individuals = best_of(archive, count);
  std::vector<Champion> champions;
  for (const ArchivedIndividual& individual : individuals) {
    const Newborn newborn = for_resimulation(archive, experiment, individual, simulator.device());
    champions.push_back({life_of(newborn, experiment, life), 0});
    champions.back().fitness = individual.result.lives.at(static_cast<std::size_t>(life - 1)).front();
  }
  return timed("verifying a life of the best individuals",
               [&] { return verify(experiment, simulator, champions, VerifiedLives::seen); });
}

void print(const std::vector<Verification>& verifications, const Objective& objective) {
  for (const Verification& verification : verifications) print(verification, objective);
  if (const std::string choice = choice_text(verifications, objective); !choice.empty()) std::cout << choice << '\n';
  std::cout << std::flush;
}

}  // namespace evodevo
