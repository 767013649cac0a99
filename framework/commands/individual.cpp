// evodevo body and genes: print the body and the genes of an individual of a run.
#include <fmt/ostream.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "archive/record_check.hpp"
#include "base/genome_sections.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "commands/commands.hpp"
#include "commands/shell/options.hpp"
#include "evolution/resimulation.hpp"
#include "life/body_json.hpp"
#include "report/genes_json.hpp"

namespace evodevo {
namespace {

/// A body, or the reason why there is none.
struct Shown {
  GivenBody given;
  std::string failure;  ///< empty if there is a body
};

Shown newborn(const Evaluation& evaluation, const Individual& individual) {
  const Newborn newborn{.id = individual.id, .generation = individual.born, .genome = &individual.genome};
  BuiltBody built = std::move(evaluation.birth.build({&newborn, 1}).front());
  if (!built.failure.empty()) return {{}, "invalid, " + built.failure};
  return {{std::move(built.body), std::nullopt, std::move(built.identities)}, ""};
}

Shown matured(const Evaluation& evaluation, const Newborn& newborn, const Scenario* scenario) {
  std::vector<Life> lives = evaluation.birth.of({&newborn, 1}, scenario);
  evaluation.development.run(lives, [](double) {});
  const Result& result = lives.front().result;
  if (!lives.front().alive()) return {{}, std::string(name(result.status)) + ", " + result.reason};
  LivingBody& living = lives.front().living;
  return {{std::move(living.body), std::move(living.state), living.numbers.identities()}, ""};
}

int body(const Given& given) {
  const Archive archive = Archive::read(given["DIR"].as<std::string>());
  const Experiment experiment = experiment_of_run(archive, given);
  const ArchivedIndividual individual = chosen_individual(archive, given);
  check_genes(archive, experiment, individual);
  const auto simulator = opened_simulator(experiment);
  const Evaluation evaluation(experiment, *simulator);
  const Scenario* scenario = given_developing_scenario(experiment, given);
  const auto require_matured = [&](const char* option, const std::string& value) {
    if (given.contains(option) && !given.contains("matured"))
      throw UsageError(option_text(option, value) +
                       ": robots are born with the same body in every scene and life; add --matured");
  };
  require_matured("scenario", scenario != nullptr ? scenario->name : "");
  require_matured("life", std::to_string(given_life_number(given).value_or(1)));
  const Shown shown = given.contains("matured")
                          ? matured(evaluation,
                                    given_life(for_resimulation(archive, experiment, individual, simulator->device()),
                                               experiment, given),
                                    scenario)
                          : newborn(evaluation, individual);
  if (!shown.failure.empty()) {
    std::cerr << "individual " << individual.id << " has no body to show: " << shown.failure << '\n';
    return 1;
  }
  std::cout << body_to_json(shown.given, experiment.context.material_names) << '\n';
  return 0;
}

/// Prints a line for each block: its type, its id, and its genes by name.
void print_genes(const nlohmann::ordered_json& sections) {
  for (const auto& section : sections) {
    std::cout << section["owner"].get<std::string>() << '\n';
    for (const auto& block : section["blocks"]) {
      fmt::print(std::cout, "  {} {}:", block["type"].get<std::string>(), block["id"].get<std::string>());
      for (const auto& [name, value] : block["genes"].items())
        std::cout << ' ' << name << " = "
                  << (value.is_string() ? value.get<std::string>() : short_number(value.get<double>()))
                  << (name == std::prev(block["genes"].end()).key() ? "" : ",");
      std::cout << '\n';
    }
  }
}

int genes(const Given& given) {
  const Archive archive = Archive::read(given["DIR"].as<std::string>());
  const ArchivedIndividual individual = chosen_individual(archive, given);
  const Layout& layout = archive.layout();
  if (const std::string fault = genome_fault(individual.genome, layout); !fault.empty())
    archive.refuse("individual " + std::to_string(individual.id) + " has " + fault);
  const nlohmann::ordered_json sections = genes_json(individual.genome, layout);
  if (given.contains("json"))
    std::cout << json_text({{"individual", individual.id}, {"sections", sections}}) << '\n';
  else
    print_genes(sections);
  return 0;
}

}  // namespace

Command genes_command() {
  Options options;
  add_individual_option(options);
  options.add_options()("json", "print JSON");
  return {.name = "genes",
          .arguments = {{"DIR"}},
          .summary = "Print the genes of a robot by name",
          .text = {"A genome has a section for each operator that owns genes, and each section has blocks of genes. "
                   "Blocks of two individuals with equal ids descend from the same block. The value of a choice is "
                   "the name of the option or, if the encoding gives it none, its number, counted from 0; the value of "
                   "a reference is the id of a block."},
          .examples = {"genes runs/quickstart-1", "genes runs/quickstart-1 --individual 295 --json"},
          .options = options,
          .function = genes};
}

Command body_command() {
  Options options;
  add_individual_option(options);
  options.add_options()("matured", "print the body after development, with its positions and velocities at that time");
  add_life_option(options, "with --matured: the body that has matured in this life");
  add_scenario_option(options, "with --matured: the body that has matured in this scenario");
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
