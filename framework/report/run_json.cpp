#include "report/run_json.hpp"

#include <algorithm>

#include "evolution/evolution.hpp"
#include "report/lineage.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;

Json optional_json(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json objectives_json(const std::vector<Objective>& objectives) {
  Json list = Json::array();
  for (const Objective& o : objectives) list.push_back({{"name", o.name}, {"unit", o.unit}, {"maximise", o.maximise}});
  return list;
}

Json operators_json(const std::vector<OperatorUse>& uses) {
  Json list = Json::array();
  for (const OperatorUse& use : uses)
    list.push_back({{"kind", use.kind},
                    {"name", use.name},
                    {"version", use.version},
                    {"file", use.file.string()},
                    {"hash", use.hash}});
  return list;
}

Json provenances_json(const std::vector<Provenance>& provenances) {
  Json list = Json::array();
  for (const Provenance& provenance : provenances)
    list.push_back({{"device", provenance.device},
                    {"evodevo", provenance.version},
                    {"program", provenance.program},
                    {"operators", operators_json(provenance.operators)}});
  return list;
}

/// Returns whether all of the best individuals that the experiment asks to verify have been verified.
bool is_verified(const Archive& archive, const Settings& settings) {
  const auto best = archive.best(static_cast<std::size_t>(settings.verify));
  return std::all_of(best.begin(), best.end(), [&](std::uint32_t id) { return archive.verification(id).has_value(); });
}

Json generations_json(const std::vector<Summary>& generations) {
  Json list = Json::array();
  for (const Summary& s : generations)
    list.push_back({{"generation", s.generation},
                    {"evaluations", s.evaluations},
                    {"best", optional_json(s.best)},
                    {"median", optional_json(s.median)},
                    {"diverged", s.diverged},
                    {"invalid", s.invalid},
                    {"clones", s.clones},
                    {"spring_evaluations", s.spring_evaluations},
                    {"wall_time", s.wall_time},
                    {"provenance", s.provenance}});
  return list;
}

Json failures_json(const std::vector<Failure>& failures) {
  Json list = Json::array();
  for (const Failure& f : failures) list.push_back({{"status", f.status}, {"reason", f.reason}, {"count", f.count}});
  return list;
}

/// The scores of an individual in each scenario, by repeat and objective.
Json tests_json(const std::vector<ArchivedTest>& tests) {
  Json list = Json::array();
  for (const ArchivedTest& test : tests) {
    const bool is_next =
        list.empty() || list.back()["scenario"] != test.scenario || list.back()["repeat"] != test.repeat + 1;
    if (is_next)
      list.push_back({{"scenario", test.scenario}, {"repeat", test.repeat + 1}, {"objectives", Json::object()}});
    list.back()["objectives"][test.objective] = test.value;
  }
  return list;
}

}  // namespace

std::int64_t clones(const std::vector<Summary>& generations) {
  std::int64_t sum = 0;
  for (const Summary& summary : generations) sum += summary.clones;
  return sum;
}

std::uint32_t last_age(const ArchivedIndividual& individual, std::uint32_t last_generation) {
  return individual.age(individual.died.value_or(last_generation));
}

Json individual_json(const Archive& archive, const ArchivedIndividual& individual) {
  const std::vector<Objective> objectives = archive.objectives();
  const auto line = ancestry(archive, individual.id);
  const std::vector<Summary> generations = archive.generations();
  Json values = Json::object();
  for (std::size_t i = 0; i < individual.result.objectives.size(); ++i)
    values[objectives[i].name] = individual.result.objectives[i];
  Json measures = Json::object();
  for (const ArchivedMeasure& measure : archive.measures(individual.id)) measures[measure.name] = measure.value;
  Json notes = Json::object();
  for (const ArchivedNote& note : archive.notes(individual.id)) notes[note.name] = note.value;
  Json ancestors = Json::array();
  for (std::size_t i = 1; i < line.size(); ++i) ancestors.push_back(line[i].id);
  const auto verification = archive.verification(individual.id);
  return {{"individual", individual.id},
          {"generation", individual.born},
          {"age", last_age(individual, generations.empty() ? 0 : generations.back().generation)},
          {"status", name(individual.result.status)},
          {"objectives", std::move(values)},
          {"measures", std::move(measures)},
          {"notes", std::move(notes)},
          {"scenarios", tests_json(archive.tests(individual.id))},
          {"parents", individual.parents},
          {"made_by", individual.made_by},
          {"ancestry", std::move(ancestors)},
          {"block_changes", line_changes_json(line, archive.layout())},
          {"verification", verification ? verification_json(*verification, objectives.front()) : Json(nullptr)}};
}

Json verification_json(const Verification& verification, const Objective& objective) {
  Json trials = Json::array();
  for (const Trial& trial : verification.trials)
    trials.push_back({{"trial", trial.name},
                      {"status", name(trial.status)},
                      {"reason", trial.reason},
                      {"value", trial.value ? Json(*trial.value) : Json(nullptr)},
                      {"held", held(verification, trial, objective.maximise)}});
  return {{"individual", verification.individual},
          {"fitness", verification.fitness},
          {"marks", marks(verification, objective.maximise)},
          {"trials", std::move(trials)}};
}

Json run_json(const Archive& archive, const Settings& settings) {
  const std::vector<Summary> generations = archive.generations();
  Json root = {{"folder", archive.folder().string()},
               {"experiment", archive.record("name")},
               {"seed", settings.seed},
               {"created", archive.record("created")},
               {"evaluations", generations.empty() ? 0 : generations.back().evaluations},
               {"evaluations_asked", settings.evaluations},
               {"finished", is_finished(settings, generations)},
               {"verified", is_verified(archive, settings)},
               {"statuses", archive.statuses()},
               {"clones", clones(generations)},
               {"failures", failures_json(archive.failures())},
               {"objectives", objectives_json(archive.objectives())},
               {"provenances", provenances_json(archive.provenances())},
               {"generations", generations_json(generations)}};
  const auto best = archive.best(1);
  root["best"] = best.empty() ? Json(nullptr) : individual_json(archive, archive.known_individual(best.front()));
  return root;
}

}  // namespace evodevo
