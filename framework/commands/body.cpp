// evodevo body: a body out of a run.
#include <iostream>

#include "commands/options.hpp"
#include "evolution/record_check.hpp"
#include "evolution/resimulation.hpp"
#include "experiment/device.hpp"
#include "life/body_json.hpp"

namespace evodevo {
namespace {

namespace po = boost::program_options;

/// A body, or why there is none.
struct Shown {
  GivenBody given;
  std::string failure;  ///< empty where there is a body
};

Shown newborn(const Evaluation& evaluation, const Individual& individual) {
  const Newborn newborn{individual.id, individual.born, &individual.genome};
  BuiltBody built = std::move(evaluation.build({&newborn, 1}).front());
  if (!built.failure.empty()) return {{}, "invalid, " + built.failure};
  return {{std::move(built.body), std::nullopt}, ""};
}

Shown matured(const Evaluation& evaluation, const Newborn& newborn) {
  std::vector<Life> lives = evaluation.birth({&newborn, 1});
  evaluation.develop(lives, [](double) {});
  const Result& result = lives.front().result;
  if (!lives.front().alive()) return {{}, std::string(name(result.status)) + ", " + result.reason};
  LivingBody& living = lives.front().living;
  return {{std::move(living.body), std::move(living.state)}, ""};
}

}  // namespace

int body_command(const Arguments& arguments) {
  CommandLine line{"body DIR [--individual ID] [--matured] [--plugin-path P]", {"DIR"}, {}};
  add_plugin_option(line.options);
  line.options.add_options()("individual", po::value<std::int64_t>(), "its id; default: the best")(
      "matured",
      "as it is after the development cycles of its life, in the motion that it is in then, not as it is born");
  const auto given = parse(std::move(line), arguments);
  if (!given) return 0;
  const Archive archive = Archive::read((*given)["DIR"].as<std::string>());
  const Experiment experiment = experiment_to_live_again(archive, given_plugin_path(*given));
  const ArchivedIndividual individual = chosen_individual(archive, *given);
  check_genes(archive, experiment, individual);
  const auto simulator = make_simulator(experiment);
  const Evaluation evaluation(experiment, *simulator);
  const Shown shown = given->contains("matured")
                          ? matured(evaluation, born_again(archive, experiment, individual, simulator->device()))
                          : newborn(evaluation, individual);
  if (!shown.failure.empty()) {
    std::cerr << "individual " << individual.id << " has no body to show: " << shown.failure << '\n';
    return 1;
  }
  std::cout << body_to_json(shown.given, experiment.world.material_names) << '\n';
  return 0;
}

}  // namespace evodevo
