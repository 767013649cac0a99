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
  /// Adds rows for robots on a floor, whose true fitnesses are `truth`, to `table`.
  Comparison(Table& table, std::string floor, std::vector<double> truth)
      : table_(table), floor_(std::move(floor)), truth_(std::move(truth)) {}

  void add(const std::string& body, const std::string& kind, const Setting& setting, const Fitnesses& measured) {
    const Interval interval = bootstrap_interval(truth_, measured.values, 500);
    table_.add({floor_, body, kind, std::string(name(setting.method)), name(setting.precision), setting.dt,
                measured.cost, rank_correlation(truth_, measured.values), interval.low, interval.high,
                best_found(truth_, measured.values, 20, 3, 2000), measured.diverged,
                static_cast<double>(truth_.size())});
  }

 private:
  Table& table_;
  std::string floor_;
  std::vector<double> truth_;
};

void compare(Table& table, const Settings& settings, bool on_rigid_floor) {
  const auto on_floor = [&](Experiment experiment) {
    if (on_rigid_floor) experiment.scene.floor = rigid_floor;
    return experiment;
  };
  const Experiment experiment = on_floor(experiment_of(settings));
  std::vector<std::pair<std::string, Experiment>> coarser;  // read first, so that their faults cost no time
  for (const Coarser& one : coarser_bodies())
    coarser.emplace_back(one.name, on_floor(experiment_of(settings, one.overrides)));
  const std::vector<Genome> genomes = random_genomes(experiment, settings.robots, 1);
  std::vector<Body> bodies;
  for (const Genome& genome : genomes) bodies.push_back(*robot_of(experiment, genome));

  const Device host{"cpu", settings.device.threads};
  const Fitnesses truth = measure(experiment, bodies, reference, host);
  Comparison comparison(table, on_rigid_floor ? "rigid" : "elastic", truth.values);
  comparison.add("as it is", "reference moved by 1e-9 m", reference,
                 measure(experiment, bodies, reference, host, 1e-9));
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
  Table table("ranking", {"floor", "body", "kind", "method", "precision", "dt (s)", "cost (s per simulated s)",
                          "rank correlation (1)", "low (1)", "high (1)", "best of 20 in reference's best 3 (1)",
                          "diverged (1)", "robots"});
  for (const bool on_rigid_floor : {false, true}) compare(table, settings, on_rigid_floor);
  return {table};
}

}  // namespace evodevo::tools::accuracy
