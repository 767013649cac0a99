#include <algorithm>

#include "batch.hpp"
#include "common/robots.hpp"
#include "studies.hpp"
#include "threads/parallel.hpp"

namespace evodevo::tools::bench {
namespace {

/// The bodies that are measured: copies of one body, or random robots of an experiment.
struct Subjects {
  NamedBody first;
  std::vector<Body> bodies;
  Scene scene;
};

Subjects subjects(const Settings& settings) {
  if (settings.robots.empty()) {
    NamedBody body = body_named(settings.body, settings.masses, settings.materials);
    return {body, {body.body}, walking_scene()};
  }
  const Experiment experiment = read_experiment({settings.robots, {}});
  std::vector<Body> robots = random_robots(experiment, settings.bodies, 1);
  return {{"random robots of " + settings.robots, robots.front()}, std::move(robots), experiment.scene};
}

double mean_springs(const std::vector<Body>& bodies) {
  std::size_t sum = 0;
  for (const Body& body : bodies) sum += body.springs.size();
  return static_cast<double>(sum) / static_cast<double>(bodies.size());
}

constexpr std::size_t least_bodies = 32;  // of the study of sizes

/// The median rates of the steps without records and with stress. The first run compiles the kernels of a GPU.
struct Rates {
  double plain, stress;
};

Rates rates(Batch& batch, int runs) {
  batch.rate();
  batch.rate({.stress = true});
  std::vector<double> plain, stress;
  for (int run = 0; run < runs; ++run) {
    plain.push_back(batch.rate().device);
    stress.push_back(batch.rate({.stress = true}).device);
  }
  return {median(plain), median(stress)};
}

}  // namespace

Report speed(const Settings& settings) {
  const Subjects measured = subjects(settings);
  Batch batch(settings, measured.bodies, measured.scene);
  // warm-up, in which the kernels of a GPU are compiled
  batch.rate();
  batch.rate({.stress = true});
  batch.rate({.work = true});
  std::vector<double> whole, plain, stress, work;
  // measures the rates by turns, so that other load on the machine affects all of them equally
  for (int run = 0; run < settings.runs; ++run) {
    const Rate rate = batch.rate();
    whole.push_back(rate.whole);
    plain.push_back(rate.device);
    stress.push_back(batch.rate({.stress = true}).device / rate.device);
    work.push_back(batch.rate({.work = true}).device / rate.device);
  }
  Report report = conditions(settings, "Speed", batch.device(), measured.first);
  report["springs"] = mean_springs(measured.bodies);
  report["scene"] = description(measured.scene);
  Report row = {{"spring_evaluations_per_second", median(plain)}};
  if (settings.device == "cpu") {
    const int cores = std::min<int>(thread_count(settings.threads), static_cast<int>(settings.bodies));
    report["threads"] = cores;
    row["per_second_and_core"] = median(plain) / cores;
  } else {
    row["per_second_with_copies"] = median(whole);
  }
  row["rate_with_stress"] = median(stress);
  row["rate_with_work"] = median(work);
  report["rows"] = Report::array({row});
  return report;
}

Report sizes(const Settings& settings) {
  Report report, rows = Report::array();
  for (const std::uint32_t masses : {64, 128, 250, 500, 1000, 1200, 1500, 2000, 3000, 5000, 10000, 20000, 50000}) {
    Settings of_size = settings;
    of_size.bodies = std::max<std::size_t>(settings.bodies * settings.masses / masses, least_bodies);
    const NamedBody body = body_named(settings.body, masses, settings.materials);
    const std::vector<Body> bodies{body.body};
    Batch batch(of_size, bodies, walking_scene());
    if (report.empty()) report = conditions(settings, "Speed for bodies of different sizes", batch.device(), body);
    const auto [rate, stress] = rates(batch, settings.runs);
    rows.push_back({{"masses", masses},
                    {"springs", body.body.springs.size()},
                    {"bodies", of_size.bodies},
                    {"spring_evaluations_per_second", rate},
                    {"with_stress", stress}});
  }
  for (const char* differs : {"body", "masses", "springs", "bodies"}) report.erase(differs);
  report["rows"] = std::move(rows);
  return report;
}

Report numbers(const Settings& settings) {
  const NamedBody body = body_named(settings.body, settings.masses, settings.materials);
  const std::vector<Body> bodies{body.body};
  Report report, rows = Report::array();
  for (std::size_t number = 1; number <= settings.bodies; number *= 2) {
    Settings of_number = settings;
    of_number.bodies = number;
    Batch batch(of_number, bodies, walking_scene());
    if (report.empty()) report = conditions(settings, "Speed for different numbers of bodies", batch.device(), body);
    const auto [rate, stress] = rates(batch, settings.runs);
    rows.push_back({{"bodies", number}, {"spring_evaluations_per_second", rate}, {"with_stress", stress}});
  }
  report.erase("bodies");
  report["rows"] = std::move(rows);
  return report;
}

}  // namespace evodevo::tools::bench
