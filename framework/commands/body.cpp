// evodevo body: prints a body of a run as JSON.
#include <iostream>

#include "commands/commands.hpp"
#include "commands/shell/options.hpp"
#include "evolution/record_check.hpp"
#include "evolution/resimulation.hpp"
#include "life/body_json.hpp"

namespace evodevo {
namespace {

/// A body, or the reason why there is none.
struct Shown {
  GivenBody given;
  std::string failure;  ///< empty if there is a body
};

Shown newborn(const Evaluation& evaluation, const Individual& individual) {
  const Newborn newborn{individual.id, individual.born, &individual.genome};
  BuiltBody built = std::move(evaluation.birth.build({&newborn, 1}).front());
  if (!built.failure.empty()) return {{}, "invalid, " + built.failure};
  return {{std::move(built.body), std::nullopt}, ""};
}

Shown matured(const Evaluation& evaluation, const Newborn& newborn) {
  std::vector<Life> lives = evaluation.birth.of({&newborn, 1});
  evaluation.development.run(lives, [](double) {});
  const Result& result = lives.front().result;
  if (!lives.front().alive()) return {{}, std::string(name(result.status)) + ", " + result.reason};
  LivingBody& living = lives.front().living;
  return {{std::move(living.body), std::move(living.state)}, ""};
}

int body(const Given& given) {
  const Archive archive = Archive::read(given["DIR"].as<std::string>());
  const Experiment experiment = experiment_of_run(archive, given);
  const ArchivedIndividual individual = chosen_individual(archive, given);
  check_genes(archive, experiment, individual);
  const auto simulator = opened_simulator(experiment);
  const Evaluation evaluation(experiment, *simulator);
  const Shown shown = given.contains("matured")
                          ? matured(evaluation, for_resimulation(archive, experiment, individual, simulator->device()))
                          : newborn(evaluation, individual);
  if (!shown.failure.empty()) {
    std::cerr << "individual " << individual.id << " has no body to show: " << shown.failure << '\n';
    return 1;
  }
  std::cout << body_to_json(shown.given, experiment.context.material_names) << '\n';
  return 0;
}

}  // namespace

Command body_command() {
  Options options;
  add_individual_option(options);
  options.add_options()("matured", "print the body after development, with its positions and velocities at that time");
  add_plugin_option(options);
  return {.name = "body",
          .arguments = {{"DIR"}},
          .summary = "Print a robot of a run as JSON",
          .text = {"The JSON holds the masses, springs and materials of the body at birth or, with --matured, after "
                   "development, in SI units. `simulate` reads it."},
          .examples = {"body runs/quickstart-1 > newborn.json", "body runs/quickstart-1 --matured > matured.json"},
          .options = options,
          .function = body};
}

}  // namespace evodevo
