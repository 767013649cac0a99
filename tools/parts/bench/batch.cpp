#include "batch.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <stdexcept>

#include "analysis/ground.hpp"
#include "common/bodies.hpp"
#include "cpu/simulator.hpp"
#ifdef EVODEVO_CUDA
#include "cuda/runtime/cuda_simulator.hpp"
#endif

namespace evodevo::tools::bench {
namespace {

std::unique_ptr<Simulator> make_simulator(const Settings& settings, const Scene& scene, Materials materials) {
  Stepping stepping = settings.stepping();
  stepping.materials = materials;
#ifdef EVODEVO_CUDA
  if (settings.device == "cuda") return make_cuda_simulator(scene, stepping);
#endif
  return make_cpu_simulator(scene, stepping, settings.threads);
}

/// The time that a GPU needed for the steps without copies, s; nothing for the CPU, which copies nothing.
std::optional<double> device_seconds([[maybe_unused]] const Simulator& simulator) {
#ifdef EVODEVO_CUDA
  if (const auto* cuda = dynamic_cast<const CudaSimulator*>(&simulator)) return cuda->device_seconds();
#endif
  return std::nullopt;
}

}  // namespace

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

Batch::Batch(const Settings& settings, std::span<const Body> bodies, const Scene& scene, Materials materials)
    : bodies_(bodies),
      scene_(scene),
      simulator_(make_simulator(settings, scene, materials)),
      states_(settings.bodies),
      steps_(settings.steps) {
  for (const Body& body : bodies) births_.push_back(state_at_birth(body, scene));
}

Rate Batch::rate(Recording recording, const std::vector<SamplePoint>& sampled_at) {
  std::vector<Task> tasks(states_.size());
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    states_[i] = births_[i % births_.size()];
    tasks[i].body = &bodies_[i % bodies_.size()];
    tasks[i].state = &states_[i];
    tasks[i].dt = time_step;
    tasks[i].steps = steps_;
    tasks[i].sampled_at = sampled_at;
  }
  const auto start = std::chrono::steady_clock::now();
  simulator_->run(tasks, recording);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  double evaluations = 0;
  for (const Task& task : tasks) {
    if (task.status != Status::ok) throw std::runtime_error("a body has diverged: " + task.reason);
    evaluations += static_cast<double>(task.spring_evaluations);
  }
  return {evaluations / seconds.count(), evaluations / device_seconds(*simulator_).value_or(seconds.count())};
}

}  // namespace evodevo::tools::bench
