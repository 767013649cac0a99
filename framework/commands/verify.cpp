// evodevo verify: checks whether the best individuals keep their fitness if they are simulated again in other ways.
#include <iostream>
#include <nlohmann/json.hpp>

#include "base/json_text.hpp"
#include "commands/commands.hpp"
#include "commands/shell/options.hpp"
#include "commands/shell/output/notices.hpp"
#include "commands/shell/verification_report.hpp"
#include "engine/builds.hpp"
#include "engine/run.hpp"
#include "report/run_json.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t most_verified = 1000;

int verify(const Given& given) {
  const auto best = given["best"].as<std::int64_t>();
  if (best < 1 || best > most_verified)
    throw UsageError("--best " + std::to_string(best) + ": expected 1 to " + std::to_string(most_verified));
  Archive archive = Archive::annotate(given["DIR"].as<std::string>());
  if (archive.best(1).empty())
    throw ArchiveError(archive.folder().string() + ": no individual has a fitness that could be verified; see `" +
                       shell_command({"show", archive.folder().string()}) + "`");
  const Experiment experiment = experiment_of_run(archive, given);
  if (!is_verifiable(experiment))
    throw ArchiveError(archive.folder().string() + ": its first objective, " + experiment.objectives.front().name +
                       ", is measured within the life, which verification does not repeat; put an operator that "
                       "measures after maturing first");
  const auto simulator = opened_simulator(experiment);
  print_warnings(other_builds(experiment, *simulator, archive));
  const std::optional<std::int64_t> life = given_life_number(given);
  const auto count = static_cast<std::size_t>(best);
  const auto verifications = life ? verify_life_of_best(experiment, *simulator, archive, count, *life)
                                  : timed("verifying the best individuals",
                                          [&] { return verify_best(experiment, *simulator, archive, count); });
  const Objective& objective = experiment.objectives.front();
  if (!given.contains("json")) {
    print(verifications, objective);
    return 0;
  }
  Json all = Json::array();
  for (const Verification& verification : verifications) all.push_back(verification_json(verification, objective));
  std::cout << json_text(all) << '\n';
  return 0;
}

}  // namespace

Command verify_command() {
  Options options;
  options.add_options()("best", value<std::int64_t>("N")->default_value(3),
                        "how many of the best individuals to verify")("json", "print JSON");
  add_life_option(options, "verify this life alone, and store nothing");
  add_plugin_option(options);
  return {
      .name = "verify",
      .arguments = {{"DIR"}},
      .summary = "Check whether the best robots of a run keep their fitness",
      .text = {"It simulates each of them again with a smaller time step, with another method, from perturbed "
               "starts, without muscles, for longer, and in lives to come, and stores the results in the run. The run "
               "may still be in progress. `help verification` explains the trials."},
      .examples = {"verify runs/quickstart-1 --best 10"},
      .options = options,
      .function = verify};
}

}  // namespace evodevo
