#include "evolution/selection_table.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <tuple>
#include <unordered_map>

#include "evodevo/helpers/selection/pareto.hpp"
#include "life/measurement/combining.hpp"

namespace evodevo {
namespace {

using CaseIndices = std::map<std::tuple<std::size_t, std::string_view, std::int64_t>, std::size_t>;

std::vector<Objective> descriptors_of(const Experiment& experiment) {
  std::vector<Objective> descriptors;
  for (const Objective& measure : experiment.measures)
    if (measure.role == Role::descriptor) descriptors.push_back(measure);
  return descriptors;
}

/// Returns the position of each case by its objective, scenario and repeat.
CaseIndices indices_of(const Experiment& experiment) {
  CaseIndices indices;
  for (std::size_t i = 0; i < experiment.cases.size(); ++i) {
    const Case& one = experiment.cases[i];
    indices[{one.objective, one.scenario, one.repeat}] = i;
  }
  return indices;
}

/// Fills in what a row refers to.
void set_values(const Individual& individual, const Experiment& experiment, const CaseIndices& indices,
                SelectionTable::Values& values) {
  const Result& result = individual.result;
  if (result.status != Status::ok) return;
  const auto greater_is_better = [&](std::size_t objective, double value) {
    return experiment.objectives[objective].maximise ? value : -value;
  };
  for (std::size_t o = 0; o < experiment.objectives.size(); ++o)
    values.scores.push_back(greater_is_better(o, result.objectives.at(o)));
  for (const Case& one : experiment.cases) values.cases.push_back(values.scores[one.objective]);
  std::map<std::size_t, std::vector<double>> in_lives;  // the scores in each life, by the position of their case
  for (const TestScore& test : result.tests)
    if (const auto at = indices.find({test.objective, experiment.scenarios.at(test.scenario).name, test.repeat});
        at != indices.end())
      in_lives[at->second].push_back(greater_is_better(test.objective, test.value));
  for (auto& [at, scores] : in_lives)
    values.cases[at] = combined(std::move(scores), experiment.over_lives.at(experiment.cases[at].objective), true);
  for (std::size_t i = 0; i < result.measures.size(); ++i)
    if (experiment.measures.at(i).role == Role::descriptor) values.descriptors.push_back(result.measures[i]);
}

}  // namespace

std::vector<std::uint32_t> layers(const std::vector<Individual>& individuals, const Experiment& experiment,
                                  std::uint32_t generation) {
  const SelectionTable table(individuals, experiment, generation);
  return pareto_layers(scores_and_youth(table.rows()));
}

double violation(const Result& result, const Experiment& experiment) {
  if (result.status == Status::ok) return 0;
  double sum = 0;
  for (std::size_t i = 0; i < result.measures.size(); ++i)
    if (experiment.measures.at(i).role == Role::constraint) sum += std::max(0.0, result.measures[i]);
  return sum > 0 ? sum : std::numeric_limits<double>::infinity();
}

SelectionTable::SelectionTable(const std::vector<Individual>& individuals, const Experiment& experiment,
                               std::uint32_t generation, const SelectionMemory& memory)
    : descriptors_(descriptors_of(experiment)),
      values_(individuals.size()),
      rows_(individuals.size()),
      context_{rows_, experiment.objectives, descriptors_, experiment.cases, experiment.layout, generation, memory} {
  const CaseIndices indices = indices_of(experiment);
  std::unordered_map<std::uint32_t, std::uint32_t> row_of;
  for (std::size_t i = 0; i < individuals.size(); ++i) {
    const Individual& individual = individuals[i];
    row_of[individual.id] = static_cast<std::uint32_t>(i);
    set_values(individual, experiment, indices, values_[i]);
    Candidate& row = rows_[i];
    row.scores = values_[i].scores;
    row.age = individual.age(generation);
    row.violation = violation(individual.result, experiment);
    row.cases = values_[i].cases;
    row.descriptors = values_[i].descriptors;
    row.id = individual.id;
    row.status = individual.result.status;
    row.is_newborn = individual.born == generation;
    row.parents = individual.parents;
    row.genome = &individual.genome;
    if (row.is_newborn && !individual.parents.empty())
      if (const auto parent = row_of.find(individual.parents.front()); parent != row_of.end())
        row.challenges = parent->second;
  }
}

}  // namespace evodevo
