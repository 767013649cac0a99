#include "report/run_json.hpp"

#include <algorithm>

#include "archive/progress.hpp"
#include "base/statistics.hpp"
#include "experiment/islands/neighbours.hpp"
#include "report/diversity.hpp"
#include "report/lineage.hpp"
#include "report/signal.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;

Json optional_json(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

/// The objectives, and of each the best individual.
Json objectives_json(const Archive& archive) {
  const std::vector<Objective> objectives = archive.objectives();
  Json list = Json::array();
  for (std::size_t i = 0; i < objectives.size(); ++i) {
    Json& objective = list.emplace_back(Json{{"name", objectives[i].name},
                                             {"unit", objectives[i].unit},
                                             {"maximise", objectives[i].maximise},
                                             {"best", nullptr}});
    for (const std::uint32_t id : archive.best(1, i))
      objective["best"] = {{"individual", id}, {"value", archive.known_individual(id).result.objectives.at(i)}};
  }
  return list;
}

Json measures_json(const std::vector<MeasureKind>& measures) {
  Json list = Json::array();
  for (const MeasureKind& m : measures) list.push_back({{"name", m.name}, {"unit", m.unit}, {"role", m.role}});
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

Json provenances_json(const Archive& archive) {
  const std::vector<std::int64_t> evaluated = archive.evaluated_by_provenance();
  Json list = Json::array();
  for (const Provenance& provenance : archive.provenances())
    list.push_back({{"device", provenance.device},
                    {"evodevo", provenance.version},
                    {"program", provenance.program},
                    {"operators", operators_json(provenance.operators)},
                    {"evaluations", evaluated.at(list.size())}});
  return list;
}

Json generations_json(const Archive& archive, const std::vector<Summary>& generations, const NicheMap& map,
                      const std::vector<NoteHistory>& notes) {
  const std::vector<Objective> objectives = archive.objectives();
  std::vector<std::vector<BestAndMedian>> progress;
  for (std::size_t i = 0; i < objectives.size(); ++i) progress.push_back(progress_in(archive, generations, i));
  Json list = Json::array();
  for (const Summary& s : generations) {
    Json of_each = Json::object();
    for (std::size_t i = 0; i < objectives.size(); ++i) {
      const auto& [best, median] = progress[i].at(s.generation);
      of_each[objectives[i].name] = {{"best", optional_json(best)}, {"median", optional_json(median)}};
    }
    const std::size_t i = list.size();
    Json generation = summary_json(s);
    generation["objectives"] = std::move(of_each);
    generation["map"] = map.axes.empty() ? Json(nullptr) : state_json(map, map.history.at(i));
    generation["notes"] = notes_json(notes, i);
    list.push_back(std::move(generation));
  }
  return list;
}

Json failures_json(const std::vector<Failure>& failures) {
  Json list = Json::array();
  for (const Failure& f : failures) list.push_back({{"status", f.status}, {"reason", f.reason}, {"count", f.count}});
  return list;
}

/// The scores of an individual in each scenario, by life, repeat and objective.
Json tests_json(const std::vector<ArchivedTest>& tests) {
  Json list = Json::array();
  for (const ArchivedTest& test : tests) {
    const bool is_next = list.empty() || list.back()["life"] != test.life || list.back()["scenario"] != test.scenario ||
                         list.back()["repeat"] != test.repeat + 1;
    if (is_next)
      list.push_back({{"life", test.life},
                      {"scenario", test.scenario},
                      {"repeat", test.repeat + 1},
                      {"objectives", Json::object()}});
    list.back()["objectives"][test.objective] = test.value;
  }
  return list;
}

Json migrated_json(const Migrated& from) { return {{"island", from.island}, {"individual", from.individual}}; }

/// The island whose run this is, and the individuals that came from others; null if the run has no islands.
Json island_json(const Archive& archive, const Settings& settings) {
  if (archive.island() == 0 || !settings.islands) return nullptr;
  Json immigrants = Json::array();
  for (const Immigrant& one : archive.immigrants())
    immigrants.push_back({{"individual", one.id},
                          {"generation", one.born},
                          {"died", one.died ? Json(*one.died) : Json(nullptr)},
                          {"from", migrated_json(one.from)}});
  return {{"number", archive.island()},
          {"count", settings.islands->count},
          {"topology", name_of(settings.islands->topology)},
          {"sources", sources_of(archive.island(), *settings.islands)},
          {"immigrants", std::move(immigrants)}};
}

Json notes_json(const Archive& archive, std::uint32_t id) {
  Json notes = Json::object();
  for (const ArchivedNote& note : archive.notes(id)) notes[note.name] = note.value;
  return notes;
}

}  // namespace

Json summary_json(const Summary& summary) {
  return {{"generation", summary.generation},
          {"evaluations", summary.evaluations},
          {"best", optional_json(summary.best)},
          {"median", optional_json(summary.median)},
          {"diverged", summary.diverged},
          {"invalid", summary.invalid},
          {"artefact", summary.artefact},
          {"lucky", summary.lucky},
          {"passive", summary.passive},
          {"clones", summary.clones},
          {"spring_evaluations", summary.spring_evaluations},
          {"wall_time", summary.wall_time}};
}

std::int64_t clones(const std::vector<Summary>& generations) {
  std::int64_t sum = 0;
  for (const Summary& summary : generations) sum += summary.clones;
  return sum;
}

std::uint32_t last_age(const ArchivedIndividual& individual, std::uint32_t last_generation) {
  return individual.age(individual.died.value_or(last_generation));
}

std::vector<BestAndMedian> progress_in(const Archive& archive, const std::vector<Summary>& generations,
                                       std::size_t objective) {
  std::vector<BestAndMedian> progress;
  if (objective == 0) {
    for (const Summary& summary : generations) progress.push_back({summary.best, summary.median});
    return progress;
  }
  const bool maximise = archive.objectives().at(objective).maximise;
  const std::vector<Membership> memberships = archive.memberships(objective);
  std::vector<Membership> members;
  auto next = memberships.begin();
  for (const Summary& summary : generations) {
    for (; next != memberships.end() && next->born <= summary.generation; ++next) members.push_back(*next);
    std::erase_if(members, [&](const Membership& one) { return one.died && *one.died <= summary.generation; });
    std::vector<double> scores;
    for (const Membership& one : members) scores.push_back(one.value);
    progress.push_back(best_and_median(std::move(scores), maximise));
  }
  return progress;
}

std::vector<BestSoFar> best_over_generations(const Archive& archive) {
  const bool maximise = archive.objectives().front().maximise;
  std::vector<BestSoFar> all;
  for (const Described& one : archive.described(0)) {
    if (!all.empty() && !(maximise ? one.score > all.back().value : one.score < all.back().value)) continue;
    if (!all.empty() && all.back().born == one.born) all.pop_back();
    all.push_back({one.id, one.born, one.score});
  }
  return all;
}

Json objectives_json(const std::vector<Objective>& objectives, const std::vector<double>& scores) {
  Json values = Json::object();
  for (std::size_t i = 0; i < scores.size(); ++i) values[objectives.at(i).name] = scores[i];
  return values;
}

Json measures_json(const Archive& archive, std::uint32_t id) {
  Json measures = Json::object();
  for (const ArchivedMeasure& measure : archive.measures(id)) measures[measure.name] = measure.value;
  return measures;
}

Json individual_json(const Archive& archive, const ArchivedIndividual& individual) {
  const std::vector<Objective> objectives = archive.objectives();
  const auto line = ancestry(archive, individual.id);
  const std::vector<Summary> generations = archive.generations();
  Json ancestors = Json::array(), lives = Json::array();
  for (const std::vector<double>& life : individual.result.lives) lives.push_back(objectives_json(objectives, life));
  for (std::size_t i = 1; i < line.size(); ++i) ancestors.push_back(line[i].id);
  const auto verification = archive.verification(individual.id);
  return {{"individual", individual.id},
          {"generation", individual.born},
          {"age", last_age(individual, generations.empty() ? 0 : generations.back().generation)},
          {"status", name(individual.result.status)},
          {"objectives", objectives_json(objectives, individual.result.objectives)},
          {"lived", individual.lives},
          {"lives", std::move(lives)},
          {"measures", measures_json(archive, individual.id)},
          {"notes", notes_json(archive, individual.id)},
          {"scenarios", tests_json(archive.tests(individual.id))},
          {"parents", individual.parents},
          {"made_by", individual.made_by},
          {"migrated_from", individual.migrated ? migrated_json(*individual.migrated) : Json(nullptr)},
          {"provenance", individual.provenance},
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
          {"verdict", verdict_text(verification, objective.maximise)},
          {"trials", std::move(trials)}};
}

Json run_json(const Archive& archive, const Settings& settings) {
  const std::vector<Summary> generations = archive.generations();
  const NicheMap map = niche_map(archive);
  const std::vector<NoteHistory> notes = archive.note_histories();
  Json root = {{"folder", archive.folder().string()},
               {"experiment", archive.record("name")},
               {"seed", settings.seed},
               {"island", island_json(archive, settings)},
               {"created", archive.record("created")},
               {"evaluations", generations.empty() ? 0 : generations.back().evaluations},
               {"evaluations_asked", settings.evaluations},
               {"finished", is_finished(settings, generations)},
               {"verified", is_verified(archive, settings)},
               {"statuses", archive.statuses()},
               {"clones", clones(generations)},
               {"failures", failures_json(archive.failures())},
               {"objectives", objectives_json(archive)},
               {"measures", measures_json(archive.measures())},
               {"map", map_json(map)},
               {"notes", note_titles_json(notes)},
               {"provenances", provenances_json(archive)},
               {"generations", generations_json(archive, generations, map, notes)}};
  const std::vector<SignalNumber> signal = archive.signal();
  root["signal"] = signal.empty() ? Json(nullptr) : signal_json(signal, settings, archive.objectives().front());
  const auto best = archive.best(1);
  root["best"] = best.empty() ? Json(nullptr) : individual_json(archive, archive.known_individual(best.front()));
  return root;
}

}  // namespace evodevo
