#include <limits>

#include "bench/batch.hpp"
#include "scenes.hpp"
#include "studies.hpp"
#include "threads/parallel.hpp"

namespace evodevo::tools::accuracy {
namespace {

/// Time steps, s. The durations of the scenes, 0.4 and 1 s, are whole multiples of each of them.
std::vector<double> time_steps(bool quick) {
  if (quick) return {1e-2, 2e-3, 1e-3, 5e-4, 2.5e-4};
  return {4e-2, 2e-2, 1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2.5e-4, 1.25e-4, 6.25e-5, 3.125e-5};
}

std::vector<Trial> trials(bool quick, Workers& workers) {
  const double finest = time_steps(quick).back() / 16;
  const std::vector<std::function<Trial()>> scenes = {spring_trial,
                                                      beam_trial,
                                                      swimmer_trial,
                                                      drop_trial,
                                                      slide_trial,
                                                      [&] { return walker_trial(finest); },
                                                      [&] { return rigid_drop_trial(finest); },
                                                      rigid_slide_trial,
                                                      [&] { return rigid_walker_trial(finest); }};
  std::vector<Trial> made(scenes.size());
  workers.for_each(scenes.size(), [&](std::size_t i) { made[i] = scenes[i](); });
  return made;
}

struct Measured {
  double error, cost;
};

/// Measures the error and the cost, which is the computing time per simulated second of one body, s. The cost is the
/// median over repeated runs, since the clock is coarse. On a GPU, enough bodies are simulated at once to keep it busy.
Measured measure(const Trial& trial, const Setting& setting, const Device& device) {
  constexpr double enough = 0.02;  // total time after which no further run is measured, s
  const bool on_gpu = device.name == "cuda";
  const std::vector<Traveller> fresh(on_gpu ? 1056 : 1, Traveller{&trial.body, trial.start});
  Simulation simulation(trial.scene, setting, {device.name, on_gpu ? device.threads : 1});
  std::vector<double> seconds;
  std::vector<Traveller> travellers;
  for (double spent = 0; spent < enough && seconds.size() < 50; spent += seconds.back()) {
    travellers = fresh;
    seconds.push_back(simulation.advance(travellers, trial.duration));
  }
  return {travellers[0].alive() ? trial.error(travellers[0].state) : std::numeric_limits<double>::quiet_NaN(),
          bench::median(seconds) / trial.duration / static_cast<double>(travellers.size())};
}

/// Compiles the GPU kernels in advance, on all cores at once, so that compilation does not count as cost.
void compile_kernels(const std::vector<Trial>& trials, const Device& device, Workers& workers) {
  struct Kernel {
    const Trial* trial;
    Setting setting;
  };
  std::vector<Kernel> kernels;
  for (const Trial& trial : trials)
    for (const Method method : all_methods())
      for (const Precision precision : {Precision::float32, Precision::float64})
        kernels.push_back({&trial, {method, precision, 1e-5}});
  workers.for_each(kernels.size(), [&](std::size_t i) {
    const auto& [trial, setting] = kernels[i];
    Traveller traveller{&trial->body, trial->start};
    Simulation(trial->scene, setting, {device.name, 1}).advance({&traveller, 1}, setting.dt);
  });
}

}  // namespace

std::vector<Table> work_precision(const Settings& settings) {
  Workers workers(settings.device.threads);
  Table table("work_precision", {"scene", "reference", "method", "precision", "dt (s)", "error (1)",
                                 "cost (s per simulated s)", "noise ceiling (1)"});
  const std::vector<Trial> all = trials(settings.quick, workers);
  if (settings.device.name == "cuda") compile_kernels(all, settings.device, workers);
  for (const Trial& trial : all)
    for (const Method method : all_methods())
      for (const Precision precision : {Precision::float32, Precision::float64})
        for (const double dt : time_steps(settings.quick)) {
          const Measured measured = measure(trial, {method, precision, dt}, settings.device);
          table.add({trial.name, trial.truth_by, std::string(name(method)), name(precision), dt, measured.error,
                     measured.cost, trial.ceiling});
        }
  return {table};
}

}  // namespace evodevo::tools::accuracy
