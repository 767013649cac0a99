#include "analysis/stability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/bodies.hpp"
#include "common/robots.hpp"
#include "fitnesses.hpp"
#include "limits.hpp"
#include "scenes.hpp"
#include "studies.hpp"
#include "threads/parallel.hpp"

namespace evodevo::tools::accuracy {
namespace {

constexpr double paper_dt = 0.0005, paper_floor = 1e6;  // time step, s; floor stiffness, N/m

std::vector<Method> explicit_methods() {
  std::vector<Method> methods = all_methods();
  std::erase_if(methods, [](Method method) { return !is_explicit(method); });
  return methods;
}

/// Computes a row for each item, in parallel, and adds the rows to the table.
template <class Item, class F>
void add_rows(Table& table, Workers& workers, const std::vector<Item>& items, const F& row_of) {
  std::vector<std::vector<Cell>> rows(items.size());
  workers.for_each(items.size(), [&](std::size_t i) { rows[i] = row_of(items[i]); });
  for (auto& row : rows) table.add(std::move(row));
}

Table spring_limits(Workers& workers) {
  struct Item {
    Method method;
    Oscillator oscillator;
  };
  std::vector<Item> items;
  for (const Method method : explicit_methods())
    for (const double stiffness : {500.0, 5000.0, 50000.0})
      for (const double mass : {0.02, 0.2, 2.0})
        for (const double rate : {0.0, Damping{}.rate, 100.0}) items.push_back({method, {stiffness, mass, rate}});
  Table table("stability_springs",
              {"method", "stiffness (N/m)", "mass (kg)", "damping (1/s)", "predicted dt (s)", "measured dt (s)"});
  add_rows(table, workers, items, [](const Item& item) -> std::vector<Cell> {
    const auto& [stiffness, mass, rate] = item.oscillator;
    return {std::string(name(item.method)),
            stiffness,
            mass,
            rate,
            predicted_limit(item.method, item.oscillator.frequency(), rate),
            measured_limit(item.oscillator, item.method)};
  });
  return table;
}

Table body_limits(Workers& workers) {
  struct Item {
    Method method;
    std::uint32_t masses;
  };
  std::vector<Item> items;
  for (const Method method : explicit_methods())
    for (const std::uint32_t masses : {10u, 30u, 60u}) items.push_back({method, masses});
  Table table("stability_bodies", {"method", "masses", "predicted dt (s)", "measured dt (s)"});
  add_rows(table, workers, items, [](const Item& item) -> std::vector<Cell> {
    const Body body = without_actuation(random_ball(item.masses));
    const double predicted = largest_dt(body, resting(body, {}).position, item.method);
    return {std::string(name(item.method)), static_cast<double>(item.masses), predicted,
            measured_limit(body, item.method, 0.9 * predicted, 1.1 * predicted)};
  });
  return table;
}

/// Tables that show whether the motion of a spring stays bounded, as a function of damping rate times dt and angular
/// frequency times dt: a measured map, and the theoretical boundary.
std::vector<Table> spring_map(Workers& workers, bool quick) {
  struct Item {
    Method method;
    double damping_step, phase;
  };
  const double column = quick ? 0.2 : 0.1, row = quick ? 0.2 : 0.1;
  std::vector<Item> items;
  Table boundary("stability_boundary", {"method", "damping rate * dt (1)", "lowest angular frequency * dt (1)",
                                        "highest angular frequency * dt (1)"});
  for (const Method method : explicit_methods()) {
    for (double c = column / 2; c < 3; c += column)
      for (double phase = row / 2; phase < 6; phase += row) items.push_back({method, c, phase});
    for (double c = 0; c < 3.001; c += 0.025) {
      const Band band = bounded_phases(method, c);
      boundary.add({std::string(name(method)), c, band.low, band.high});
    }
  }
  Table map("stability_map", {"method", "damping rate * dt (1)", "angular frequency * dt (1)", "bounded"});
  add_rows(map, workers, items, [](const Item& item) -> std::vector<Cell> {
    constexpr double mass = 0.2, stiffness = 1000;
    const double dt = item.phase / Oscillator{stiffness, mass, 0}.frequency();
    const bool bounded = stays_bounded({stiffness, mass, item.damping_step / dt}, item.method, dt);
    return {std::string(name(item.method)), item.damping_step, item.phase, bounded ? 1.0 : 0.0};
  });
  return {map, boundary};
}

/// The largest gains of a bounce on both floors, with the same steps; a rigid floor has restitution 1.
Table contact_gains(Workers& workers) {
  struct Item {
    Method method;
    double phase;
  };
  std::vector<Item> items;
  for (const Method method : all_methods())
    for (double phase = 0.1; phase < 2; phase += 0.05) items.push_back({method, phase});
  Table table("contact_gain", {"method", "dt * sqrt(floor stiffness / mass) (1)", "largest gain of a bounce (1)",
                               "bound of the Euler methods (1)", "largest gain on a rigid floor (1)"});
  add_rows(table, workers, items, [](const Item& item) -> std::vector<Cell> {
    constexpr double mass = 0.2;  // kg, that of contact_gain()
    const double dt = item.phase * std::sqrt(mass / Floor{}.stiffness);
    return {std::string(name(item.method)), item.phase, contact_gain(item.method, item.phase),
            1 / (1 - item.phase * item.phase / 4), rigid_contact_gain(item.method, 1, dt)};
  });
  return table;
}

/// The energy gain in a contact for the paper's method and dt, as a function of the mass and of the stiffness of the
/// floor.
Table contact_map(Workers& workers, bool quick) {
  struct Item {
    double mass, stiffness;
  };
  const int cells = quick ? 16 : 40;
  std::vector<Item> items;
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j) {
      const auto between = [&](double low, double high, int k) {
        return low * std::pow(high / low, (k + 0.5) / cells);
      };
      items.push_back({between(0.02, 2, i), between(1e5, 1e7, j)});
    }
  Table table("contact_map", {"mass (kg)", "floor stiffness (N/m)", "largest gain of a bounce (1)"});
  add_rows(table, workers, items, [](const Item& item) -> std::vector<Cell> {
    const double phase = paper_dt * std::sqrt(item.stiffness / item.mass);
    return {item.mass, item.stiffness, phase < 2 ? contact_gain(Method::paper_euler, phase) : 1e300};
  });
  return table;
}

/// Simulates random bodies in the scene of the experiment with given masses, dt and floor. Tabulates the share that
/// diverges, and how much of their fitness the best ten of the others keep at a quarter of dt.
class RandomBodies {
 public:
  RandomBodies(const Settings& settings)
      : settings_(settings),
        experiment_(measurable_experiment(settings.experiment, overrides(settings.quick))),
        bodies_(random_robots(experiment_, settings.quick ? 40 : 300, 1)) {}

  void add(double mass, double dt, const Floor& floor) {
    for (Body& body : bodies_)
      for (Mass& m : body.masses) m.mass = mass;
    experiment_.scene.floor = floor;
    const Fitnesses measured =
        measure(experiment_, bodies_, {Method::paper_euler, Precision::float32, dt}, settings_.device);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double stiffness = floor.rigid() ? nan : floor.stiffness;
    table_.add({std::string(floor.rigid() ? "rigid" : "elastic"), mass, dt, stiffness, dt * std::sqrt(stiffness / mass),
                static_cast<double>(bodies_.size()), measured.diverged, kept_by_champions(measured.values, dt)});
  }

  const Table& table() const { return table_; }

 private:
  /// Robots like the paper's but with 300 masses; a quick study keeps the bodies of the experiment and shortens the
  /// measurement instead.
  static std::vector<Override> overrides(bool quick) {
    if (quick) return {{"fitness.0.settle", "2"}, {"fitness.0.window", "2"}};
    return {{"encoding.points", "300"}, {"encoding.neighbours", "25"}};
  }

  /// The ratio of fitness at a quarter of dt (velocity-verlet in double precision) to the measured fitness; median over
  /// the best ten.
  double kept_by_champions(const std::vector<double>& values, double dt) const {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::erase_if(order, [&](std::size_t i) { return std::isnan(values[i]); });
    std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return values[i] > values[j]; });
    order.resize(std::min<std::size_t>(order.size(), 10));
    if (order.empty()) return std::numeric_limits<double>::quiet_NaN();
    std::vector<Body> champions;
    for (const std::size_t i : order) champions.push_back(bodies_[i]);
    const Device host{"cpu", settings_.device.threads};
    const Fitnesses again =
        measure(experiment_, champions, {Method::velocity_verlet, Precision::float64, dt / 4}, host);
    std::vector<double> kept;
    for (std::size_t i = 0; i < order.size(); ++i)  // what diverges keeps nothing
      kept.push_back(std::isnan(again.values[i]) ? 0 : again.values[i] / values[order[i]]);
    std::sort(kept.begin(), kept.end());
    return kept[kept.size() / 2];
  }

  const Settings& settings_;
  Experiment experiment_;
  std::vector<Body> bodies_;
  Table table_{"divergence",
               {"floor", "mass (kg)", "dt (s)", "floor stiffness (N/m)", "dt * sqrt(floor stiffness / mass) (1)",
                "bodies", "diverged (1)", "kept by the best ten at dt / 4 (1)"}};
};

Table divergence(const Settings& settings) {
  RandomBodies bodies(settings);
  for (const Floor& floor : {Floor{paper_floor}, rigid_floor})
    for (const double mass : {0.05, 0.07, 0.1, 0.12, 0.14, 0.17, 0.2, 0.3}) bodies.add(mass, paper_dt, floor);
  bodies.add(0.1, 0.0004, Floor{paper_floor});
  bodies.add(0.1, paper_dt, Floor{1e5});
  bodies.add(0.1, 2 * paper_dt, rigid_floor);
  return bodies.table();
}

}  // namespace

std::vector<Table> stability(const Settings& settings) {
  Workers workers(settings.device.threads);
  std::vector<Table> tables = spring_map(workers, settings.quick);
  tables.push_back(spring_limits(workers));
  tables.push_back(body_limits(workers));
  tables.push_back(contact_gains(workers));
  tables.push_back(contact_map(workers, settings.quick));
  tables.push_back(divergence(settings));
  return tables;
}

}  // namespace evodevo::tools::accuracy
