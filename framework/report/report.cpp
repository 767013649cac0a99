#include "report/report.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <numeric>

#include "archive/progress.hpp"
#include "archive/record_check.hpp"
#include "evolution/breeding.hpp"
#include "evolution/resimulation.hpp"
#include "life/body_building.hpp"
#include "report/diversity.hpp"
#include "report/film_json.hpp"
#include "report/filming.hpp"
#include "report/lineage.hpp"
#include "report/run_json.hpp"
#include "report/scene_json.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* elite_role = "elite";

/// An individual and the role for which it is shown, such as "best" or "ancestor".
struct Actor {
  ArchivedIndividual individual;
  std::string role;

  bool is_elite() const { return role == elite_role; }
};

class Casting {
 public:
  explicit Casting(const Archive& archive) : archive_(archive) {}

  std::vector<Actor> choose(const Cast& cast) {
    const std::vector<std::uint32_t> best = archive_.best(cast.best);
    const std::vector<Objective> objectives = archive_.objectives();
    for (std::size_t k = 0; k < objectives.size(); ++k)
      add_best(k == 0 ? best : archive_.best(cast.best_of_others, k),
               objectives.size() > 1 ? " in " + objectives[k].name : "");
    for (const std::uint32_t id : cast.individuals) add(id, "chosen");
    if (!best.empty()) add_ancestors(ancestry(archive_, best.front()), cast.ancestors);
    if (cast.elites > 0)
      for (const std::uint32_t id : best_elites(niche_map(archive_), cast.elites)) add(id, elite_role);
    return std::move(roles_);
  }

 private:
  /// Adds the best individuals by an objective. `where` says by which, if there are several.
  void add_best(const std::vector<std::uint32_t>& ids, const std::string& where) {
    for (std::size_t i = 0; i < ids.size(); ++i)
      add(ids[i], "best" + (i == 0 ? "" : " " + std::to_string(i + 1)) + where);
  }

  void add(std::uint32_t id, const std::string& role) {
    if (std::any_of(roles_.begin(), roles_.end(), [&](const Actor& r) { return r.individual.id == id; })) return;
    roles_.push_back({archive_.known_individual(id), role});
  }

  /// Adds `count` ancestors, evenly spaced. `line` begins with the descendant and ends with the founder.
  void add_ancestors(const std::vector<ArchivedIndividual>& line, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t back = (line.size() - 1) * (count - i) / count;
      if (back > 0) add(line[back].id, back + 1 == line.size() ? "founder" : "ancestor");
    }
  }

  const Archive& archive_;
  std::vector<Actor> roles_;
};

/// The time after maturing at which the first window opens, s.
double first_window(const Experiment& experiment) {
  double opens = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < experiment.fitness.size(); ++i)
    if (const Request request = fitness_request(experiment, i); !request.cycle) opens = std::min(opens, request.settle);
  return opens;
}

/// Returns the title of each shot of a life whose final evaluation was that of `scenario`, if the experiment has any.
std::vector<Title> titles_of(const FilmedLife& life, const Experiment& experiment, std::size_t scenario) {
  const double measured_from = static_cast<double>(life.cycles) * experiment.development.cycle_time +
                               first_window(experiment) - 0.5 / filmed_frames_per_second;
  const std::string where = experiment.scenarios.empty() ? "" : " in " + experiment.scenarios[scenario].name;
  std::vector<Title> titles;
  for (std::size_t i = 0; i < life.film.size(); ++i) {
    const bool measured = life.film[i].frames.front().time >= measured_from;
    if (i < life.cycles)
      titles.push_back({"cycle " + std::to_string(i + 1)});
    else
      titles.push_back({(measured ? "measured" : "settling") + where, measured});
  }
  return titles;
}

Json population_json(const Archive& archive, std::uint32_t generation) {
  const std::vector<Objective> objectives = archive.objectives();
  Json list = Json::array();
  for (const Individual& individual : archive.population())
    if (individual.result.status == Status::ok)
      list.push_back({{"id", individual.id},
                      {"age", individual.age(generation)},
                      {"objectives", objectives_json(objectives, individual.result.objectives)},
                      {"measures", measures_json(archive, individual.id)}});
  return list;
}

Json time_json(const Archive& archive) {
  const std::optional<TimeSpent> time = recorded_time_spent(archive);
  if (!time) return nullptr;
  return {{"whole", time->whole},
          {"archive", time->archive},
          {"decode", time->evaluation.decode},
          {"simulate", time->evaluation.simulate},
          {"develop", time->evaluation.develop},
          {"verify", time->verify}};
}

/// Returns a film in which points move to the positions that the encoding maps them to, and then become a body. If the
/// encoding maps no points, the film shows only the body.
Film mapping_film(const Blueprint& blueprint, BuiltBody built) {
  constexpr int frames = 60;
  constexpr double duration = 2;  // s
  const std::vector<Mass>& masses = blueprint.body.masses;
  Film film;
  if (!blueprint.origins.empty()) {
    Shot& mapping = film.emplace_back();
    mapping.body.masses = masses;
    mapping.body.materials = blueprint.body.materials;
    mapping.numbers.resize(masses.size());
    std::iota(mapping.numbers.begin(), mapping.numbers.end(), 0u);
    for (int f = 0; f <= frames; ++f) {
      const double t = static_cast<double>(f) / frames, part = t * t * (3 - 2 * t);  // slow at both ends
      Frame& frame = mapping.frames.emplace_back(Frame{duration * t, {}});
      for (std::size_t i = 0; i < masses.size(); ++i)
        frame.positions.push_back(seen((1 - part) * blueprint.origins[i] + part * masses[i].rest));
    }
  }
  const double end = film.empty() ? 0 : duration;
  for (std::size_t i = 0; i < built.kept.size(); ++i) built.body.masses[i].rest = masses[built.kept[i]].rest;
  Shot& body = film.emplace_back(Shot{std::move(built.body), {}, {}, std::move(built.kept)});
  body.stress.resize(body.body.springs.size());
  for (const double time : {end, end + 1}) {
    Frame& frame = body.frames.emplace_back(Frame{time, {}});
    for (const Mass& mass : body.body.masses) frame.positions.push_back(seen(mass.rest));
  }
  return film;
}

Json random_robot(const Experiment& experiment, const Individual& individual, std::size_t budget) {
  const Blueprint blueprint = decoded(experiment, individual.genome, {.individual = individual.id});
  BuiltBody built = build_body(experiment, blueprint, {.individual = individual.id});
  Json robot = {{"individual", individual.id}, {"role", "random"}, {"reason", built.failure}};
  robot["status"] = name(built.failure.empty() ? Status::ok : Status::invalid);
  Film film;
  if (built.failure.empty()) film = mapping_film(blueprint, std::move(built));
  std::vector<Title> titles = {{"mapping"}, {"body"}};
  if (film.size() == 1) titles.erase(titles.begin());
  robot["film"] = film_json(film, titles, budget);
  return robot;
}

/// A life that a page shows.
struct ShownLife {
  const Actor* actor = nullptr;
  Newborn newborn;
};

std::vector<ShownLife> shown_lives(const Archive& archive, const Experiment& experiment,
                                   const std::vector<Actor>& actors, const std::optional<std::int64_t>& life,
                                   const std::string& device) {
  std::vector<const Individual*> individuals;
  for (const Actor& actor : actors) individuals.push_back(&actor.individual);
  const std::vector<Newborn> newborns = for_resimulation(archive, experiment, individuals, device);
  std::vector<ShownLife> shown;
  for (std::size_t i = 0; i < actors.size(); ++i) {
    std::vector<Newborn> lives = each_life(experiment, {&newborns[i], 1});
    const std::int64_t most = actors[i].is_elite() ? 1 : experiment.lives;  // more if it has lived again
    for (Newborn& one : lives)
      if (life ? one.life == *life : one.life <= most) shown.push_back({&actors[i], std::move(one)});
  }
  return shown;
}

Json robot_json(const Archive& archive, const Actor& role, const FilmedLife& life, const Experiment& experiment,
                std::size_t scenario, std::size_t budget) {
  Json robot = individual_json(archive, role.individual);
  robot["life"] = life.number;
  robot["role"] = role.role;
  robot["reason"] = role.individual.result.reason;
  robot["again"] = life.result.objectives;  // of the test that is filmed
  robot["film"] = film_json(life.film, titles_of(life, experiment, scenario), budget);
  return robot;
}

/// Divides a budget of bytes among films. Half of it is for the elites, if there are any, and the other half for those
/// before them; each half is shared evenly. What is not used is left to the films after it.
class FilmBudget {
 public:
  FilmBudget(std::size_t bytes, const std::vector<ShownLife>& lives) : left_(bytes) {
    for (const ShownLife& life : lives) ++(life.actor->is_elite() ? elites_ : others_);
    reserved_ = others_ > 0 && elites_ > 0 ? bytes / 2 : 0;
  }

  std::size_t share(const Actor& actor) const {
    return actor.is_elite() ? left_ / elites_ : (left_ - std::min(left_, reserved_)) / others_;
  }
  void spend(const Actor& actor, std::size_t bytes) {
    left_ -= std::min(left_, bytes);
    --(actor.is_elite() ? elites_ : others_);
  }

 private:
  std::size_t left_, reserved_ = 0, elites_ = 0, others_ = 0;
};

/// Returns the parameter `direction` of the first fitness function, such as that of `distance`, for the page's track;
/// null if it has none.
Json direction_json(const std::string& experiment) {
  const toml::table table = toml::parse(experiment);
  const toml::array* direction = table["fitness"][0]["direction"].as_array();
  if (!direction || direction->size() != 3) return nullptr;
  Json components = Json::array();
  for (const toml::node& component : *direction) components.push_back(component.value_or(0.0));
  return components;
}

constexpr std::size_t most_champions = 40;  ///< number of champions that a page shows

/// Returns the body of an individual at birth as a film of one shot, in the lowest precision; an empty film if it has
/// no body.
Json newborn_json(const Archive& archive, const Experiment& experiment, const Individual& individual) {
  check_genes(archive, experiment, individual);
  Blueprint blueprint = decoded(experiment, individual.genome, {.individual = individual.id});
  blueprint.origins.clear();
  BuiltBody built = build_body(experiment, blueprint, {.individual = individual.id});
  return film_json(built.failure.empty() ? mapping_film(blueprint, std::move(built)) : Film{}, {{"birth"}}, 0);
}

/// Returns how many champions a run has had, and those shown: if there are too many, evenly spaced ones with the first
/// and the last. Those that are no actors have their bodies at birth.
Json champions_json(const Archive& archive, const Experiment& experiment, const std::vector<Actor>& actors) {
  const std::vector<BestSoFar> all = best_over_generations(archive);
  const std::size_t count = std::min(all.size(), most_champions);
  Json shown = Json::array();
  for (std::size_t i = 0; i < count; ++i) {
    const BestSoFar& one = all[count < 2 ? 0 : i * (all.size() - 1) / (count - 1)];
    const bool has_life =
        std::ranges::any_of(actors, [&](const Actor& actor) { return actor.individual.id == one.individual; });
    shown.push_back({{"individual", one.individual},
                     {"generation", one.born},
                     {"value", one.value},
                     {"film", has_life ? Json(nullptr)
                                       : newborn_json(archive, experiment, archive.known_individual(one.individual))}});
  }
  return {{"count", all.size()}, {"shown", std::move(shown)}};
}

constexpr std::size_t filmed_together = 16;  ///< number of robots whose films are in memory at the same time

}  // namespace

Json reported_run(const Archive& archive, const Experiment& experiment, Simulator& simulator, const Cast& cast,
                  std::size_t budget, std::size_t scenario) {
  const std::vector<Actor> actors = Casting(archive).choose(cast);
  Json run = run_json(archive, experiment);
  run["resolved"] = archive.record("experiment");
  run["direction"] = direction_json(archive.record("experiment"));
  run["filmed_scenario"] = experiment.scenarios.empty() ? Json(nullptr) : Json(experiment.scenarios[scenario].name);
  run["material_names"] = experiment.context.material_names;
  run["population"] = population_json(
      archive, run["generations"].empty() ? 0 : run["generations"].back()["generation"].get<std::uint32_t>());
  run["labels"] = labels_json(archive.note_histories());
  run["time"] = time_json(archive);
  run["top_speed"] = nullptr;
  run["champions"] = champions_json(archive, experiment, actors);
  run["robots"] = Json::array();
  const Scene& scene = experiment.scenarios.empty() ? experiment.scene : experiment.scenarios[scenario].scene;
  const std::vector<ShownLife> shown = shown_lives(archive, experiment, actors, cast.life, simulator.device());
  std::vector<Newborn> newborns;
  for (const ShownLife& one : shown) newborns.push_back(one.newborn);
  SeenRegion region;
  FilmBudget films(budget - std::min(budget, run["champions"].dump().size()), shown);
  for (std::size_t first = 0; first < shown.size(); first += filmed_together) {
    const std::size_t count = std::min(filmed_together, shown.size() - first);
    const std::vector<FilmedLife> lives =
        film_lives(experiment, simulator, std::span(newborns).subspan(first, count), {scenario});
    region.include(lives);
    for (std::size_t i = 0; i < count; ++i) {
      const Actor& actor = *shown[first + i].actor;
      const Json& robot =
          run["robots"].emplace_back(robot_json(archive, actor, lives[i], experiment, scenario, films.share(actor)));
      films.spend(actor, robot.dump().size());
      if (cast.best > 0 && first + i == 0)  // the best individual comes first
        run["top_speed"] = top_speed_json(scene, lives[i].film, titles_of(lives[i], experiment, scenario));
    }
  }
  run["scene"] = scene_json(scene, region);
  std::vector<std::uint32_t> ids;
  for (const Actor& actor : actors) ids.push_back(actor.individual.id);
  run["lineage"] = lineage_json(archive, ids);
  return run;
}

Json report_data(std::vector<Json> runs) {
  return {{"kind", "report"}, {"evodevo", EVODEVO_VERSION}, {"runs", std::move(runs)}};
}

Json gallery_data(const Experiment& experiment, std::size_t count) {
  Json robots = Json::array();
  for (const Individual& individual : breed(experiment, {}, 0, 0, count))
    robots.push_back(random_robot(experiment, individual, page_budget / count));
  Json run = {{"experiment", experiment.name},
              {"seed", experiment.seed},
              {"resolved", experiment.resolved},
              {"scene", scene_json({}, SeenRegion())},
              {"material_names", experiment.context.material_names},
              {"robots", std::move(robots)}};
  return {{"kind", "gallery"}, {"evodevo", EVODEVO_VERSION}, {"runs", Json::array({std::move(run)})}};
}

}  // namespace evodevo
