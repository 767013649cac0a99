// evodevo verify: whether champions keep their fitness when they are simulated again in other ways.
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "base/json_text.hpp"
#include "base/text.hpp"
#include "commands/options.hpp"
#include "commands/run.hpp"
#include "commands/verification_report.hpp"
#include "evolution/archive.hpp"
#include "evolution/resimulation.hpp"
#include "experiment/device.hpp"
#include "report/run_json.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;
namespace po = boost::program_options;

constexpr std::int64_t most_verified = 1000;

std::string number(const std::optional<double>& value) { return value ? short_number(*value) : "-"; }

}  // namespace

std::vector<Verification> verify_best(const Experiment& experiment, Simulator& simulator, Archive& archive,
                                      std::size_t count) {
  std::vector<ArchivedIndividual> individuals;
  for (const std::uint32_t id : archive.best(count)) individuals.push_back(archive.known_individual(id));
  std::vector<Champion> champions;
  for (const ArchivedIndividual& individual : individuals)
    champions.push_back(
        {born_again(archive, experiment, individual, simulator.device()), individual.result.objectives.front()});
  std::vector<Verification> verifications = verify(experiment, simulator, champions);
  archive.add_verifications(verifications);
  return verifications;
}

void print(const Verification& verification, const Objective& objective) {
  std::printf("individual %u: %s %s %s: %s\n", verification.individual, objective.name.c_str(),
              number(verification.fitness).c_str(), objective.unit.c_str(),
              marks_text(verification, objective.maximise).c_str());
  for (const Trial& trial : verification.trials) {
    const bool has_held = held(verification, trial, objective.maximise);
    const char* outcome = has_held ? "held" : trial.name == "no-muscles" ? "not held, as it should" : "not held";
    std::printf("  %-14s %10s  %s%s\n", trial.name.c_str(), number(trial.value).c_str(), outcome,
                trial.reason.empty() ? "" : (", " + std::string(name(trial.status)) + ": " + trial.reason).c_str());
  }
  std::fflush(stdout);
}

int verify_command(const Arguments& arguments) {
  CommandLine line{"verify DIR [--best N] [--json] [--plugin-path P]", {"DIR"}, {}};
  line.options.add_options()("best", po::value<std::int64_t>()->default_value(3), "how many of the best individuals")(
      "json", "machine-readable");
  add_plugin_option(line.options);
  const auto given = parse(std::move(line), arguments);
  if (!given) return 0;
  const auto best = (*given)["best"].as<std::int64_t>();
  if (best < 1 || best > most_verified)
    throw UsageError("--best " + std::to_string(best) + ": expected 1 to " + std::to_string(most_verified));
  Archive archive = Archive::annotate((*given)["DIR"].as<std::string>());
  if (archive.best(1).empty())
    throw ArchiveError(archive.folder().string() + ": no individual has a fitness to verify");
  const Experiment experiment = experiment_to_live_again(archive, given_plugin_path(*given));
  const auto simulator = make_simulator(experiment);
  warn_of_other_builds(experiment, *simulator, archive);
  const auto verifications = verify_best(experiment, *simulator, archive, static_cast<std::size_t>(best));
  const Objective& objective = experiment.objectives.front();
  Json all = Json::array();
  for (const Verification& verification : verifications) {
    if (given->contains("json"))
      all.push_back(verification_json(verification, objective));
    else
      print(verification, objective);
  }
  if (given->contains("json")) std::cout << json_text(all) << '\n';
  return 0;
}

}  // namespace evodevo
