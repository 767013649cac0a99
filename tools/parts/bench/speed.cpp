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

}  // namespace evodevo::tools::bench
