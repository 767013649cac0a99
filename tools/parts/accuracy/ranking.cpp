#include <cmath>
#include <limits>
#include <optional>

#include "common/robots.hpp"
#include "fitnesses.hpp"
#include "scenes.hpp"
#include "statistics.hpp"
#include "studies.hpp"

namespace evodevo::tools::accuracy {
namespace {

constexpr Setting usual{};
constexpr Setting reference{Method::velocity_verlet, Precision::float64, usual.dt / 16};

std::vector<double> time_steps(bool quick) {
  if (quick) return {5e-4, 1e-3};
  return {1e-4, 2e-4, 5e-4, 1e-3, 2e-3};
}

/// A change of the experiment that makes the same genomes grow bodies with fewer masses or springs.
struct Coarser {
  std::string name;
  std::vector<Override> overrides;
};

std::vector<Coarser> coarser_bodies() {
  const Override fewer_neighbours{"encoding.neighbours", "8"}, few_neighbours{"encoding.neighbours", "6"};
  const auto points = [](const char* number) { return Override{"encoding.points", number}; };
  return {{"48 masses", {points("48")}},      {"32 masses", {points("32")}},
          {"24 masses", {points("24")}},      {"8 neighbours", {fewer_neighbours}},
          {"6 neighbours", {few_neighbours}}, {"32 masses, 8 neighbours", {points("32"), fewer_neighbours}}};
}

/// A scene in which robots are ranked.
struct Ranked {
  std::string name;
  std::vector<Override> overrides;
};

/// The experiment's own scene, the same with a rigid floor, and one on a rigid floor that holds robots back so little
/// that they are fast and chance decides more: with a quarter of the damping, twice the friction, and stronger and
/// faster muscles with dashpots.
std::vector<Ranked> ranked_scenes() {
  const Override rigid{"scene.floor.restitution", "0"};
  std::vector<Override> lively = {rigid, {"scene.damping.rate", "5"}, {"scene.friction.coefficient", "1"}};
  for (const char* muscle : {"muscle", "muscle2"}) {
    lively.push_back({std::string("materials.") + muscle + ".frequency", "4"});
    lively.push_back({std::string("materials.") + muscle + ".amplitude", "0.2"});
  }
  for (const char* material : {"muscle", "muscle2", "tissue", "bone"})
    lively.push_back({std::string("materials.") + material + ".damping", "0.5"});
  return {{"elastic floor", {}}, {"rigid floor", {rigid}}, {"lively scene", lively}};
}

std::vector<Override> overrides(const Settings& settings) {
  if (!settings.quick) return {};
  return {{"fitness.0.settle", "1.5"}, {"fitness.0.window", "1.5"}};
}

Experiment experiment_of(const Settings& settings, const std::vector<Override>& more = {}) {
  std::vector<Override> all = overrides(settings);
  all.insert(all.end(), more.begin(), more.end());
  return measurable_experiment(settings.experiment, all);
}

/// Measures the bodies that the genomes grow in an experiment with coarser bodies. If a genome grows no valid body
/// there, its fitness is NaN.
Fitnesses measure_coarser(const Experiment& experiment, const std::vector<Genome>& genomes, const Device& device) {
  std::vector<Body> bodies;
  std::vector<std::size_t> whose;
  for (std::size_t i = 0; i < genomes.size(); ++i)
    if (auto body = robot_of(experiment, genomes[i])) {
      bodies.push_back(*std::move(body));
      whose.push_back(i);
    }
  Fitnesses measured = measure(experiment, bodies, usual, device);
  std::vector<double> values(genomes.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < whose.size(); ++i) values[whose[i]] = measured.values[i];
  measured.values = std::move(values);
  return measured;
}

/// A table whose rows compare measured fitnesses with those of the reference.
class Comparison {
 public:
  /// Adds rows for robots in a scene, whose fitnesses there are compared with `truth`, to `table`.
  Comparison(Table& table, std::string scene, std::vector<double> truth)
      : table_(table), scene_(std::move(scene)), truth_(std::move(truth)) {}

  void add(const std::string& body, const std::string& kind, const Setting& setting, const Fitnesses& measured) {
    const Interval interval = bootstrap_interval(truth_, measured.values, 500);
    table_.add({scene_, body, kind, std::string(name(setting.method)), name(setting.precision), setting.dt,
                measured.cost, rank_correlation(truth_, measured.values), interval.low, interval.high,
                best_found(truth_, measured.values, 20, 3, 2000), measured.diverged,
                static_cast<double>(truth_.size())});
  }

 private:
  Table& table_;
  std::string scene_;
  std::vector<double> truth_;
};

void compare(Table& table, const Settings& settings, const Ranked& scene) {
  const Experiment experiment = experiment_of(settings, scene.overrides);
  std::vector<std::pair<std::string, Experiment>> coarser;  // read first, so that their faults cost no time
  for (const Coarser& one : coarser_bodies()) {
    std::vector<Override> both = scene.overrides;
    both.insert(both.end(), one.overrides.begin(), one.overrides.end());
    coarser.emplace_back(one.name, experiment_of(settings, both));
  }
  const std::vector<Genome> genomes = random_genomes(experiment, settings.robots, 1);
  std::vector<Body> bodies;
  for (const Genome& genome : genomes) bodies.push_back(*robot_of(experiment, genome));

  const Fitnesses truth = measure(experiment, bodies, reference, settings.device);
  Comparison comparison(table, scene.name, truth.values);
  comparison.add("as it is", "reference moved by 1e-9 m", reference,
                 measure(experiment, bodies, reference, settings.device, 1e-9));
  // what the fitness of one life says of that of another one: above that, differences between settings matter little
  Comparison(table, scene.name, measure(experiment, bodies, usual, settings.device).values)
      .add("as it is", "another life", usual, measure(experiment, bodies, usual, settings.device, 1e-4));
  for (const Method method : all_methods())
    for (const Precision precision : {Precision::float32, Precision::float64})
      for (const double dt : time_steps(settings.quick)) {
        const Setting setting{method, precision, dt};
        comparison.add("as it is", "setting", setting, measure(experiment, bodies, setting, settings.device));
      }
  for (const auto& [name, of_coarser] : coarser)
    comparison.add(name, "coarser body", usual, measure_coarser(of_coarser, genomes, settings.device));
}

}  // namespace

std::vector<Table> ranking(const Settings& settings) {
  Table table("ranking", {"scene", "body", "kind", "method", "precision", "dt (s)", "cost (s per simulated s)",
                          "rank correlation (1)", "low (1)", "high (1)", "best of 20 in reference's best 3 (1)",
                          "diverged (1)", "robots"});
  for (const Ranked& scene : ranked_scenes()) compare(table, settings, scene);
  return {table};
}

}  // namespace evodevo::tools::accuracy
