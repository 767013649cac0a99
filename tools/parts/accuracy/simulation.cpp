#include "simulation.hpp"

#include <cmath>
#include <ctime>

#include "analysis/energy.hpp"
#include "cpu/simulator.hpp"
#ifdef EVODEVO_CUDA
#include "cuda/runtime/cuda_simulator.hpp"
#endif

namespace evodevo::tools::accuracy {
namespace {

std::unique_ptr<Simulator> make_simulator(const Scene& scene, const Setting& setting, const Device& device) {
  const Stepping stepping{setting.method, setting.precision};
#ifdef EVODEVO_CUDA
  if (device.name == "cuda") return make_cuda_simulator(scene, stepping, device.threads);
#endif
  return make_cpu_simulator(scene, stepping, device.threads);
}

/// The processor time that all threads of this program have used, s.
double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// The time that the GPU needed for the steps of the last run, s.
double device_seconds([[maybe_unused]] const Simulator& simulator) {
#ifdef EVODEVO_CUDA
  return dynamic_cast<const CudaSimulator&>(simulator).device_seconds();
#else
  return 0;
#endif
}

}  // namespace

std::string name(Precision precision) { return precision == Precision::float32 ? "float" : "double"; }

std::vector<Method> all_methods() {
  std::vector<Method> all;
  for (const std::string_view method : method_names) all.push_back(method_of(method));
  return all;
}

std::string Device::description() const { return make_simulator({}, {}, *this)->device(); }

Simulation::Simulation(const Scene& scene, const Setting& setting, const Device& device)
    : setting_(setting), on_host_(device.name == "cpu"), simulator_(make_simulator(scene, setting, device)) {}

double Simulation::advance(std::span<Traveller> travellers, double duration) {
  std::vector<Task> tasks(travellers.size());
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    tasks[i].body = travellers[i].body;
    tasks[i].state = &travellers[i].state;
    tasks[i].dt = setting_.dt;
    tasks[i].steps = static_cast<std::uint64_t>(std::llround(duration / setting_.dt));
    tasks[i].status = travellers[i].status;
  }
  const double before = processor_seconds();
  simulator_->run(tasks, {});
  const double seconds = on_host_ ? processor_seconds() - before : device_seconds(*simulator_);
  for (std::size_t i = 0; i < tasks.size(); ++i) travellers[i].status = tasks[i].status;
  return seconds;
}

Traveller simulate(const Body& body, const State& start, const Scene& scene, const Setting& setting, double duration) {
  Traveller traveller{&body, start};
  Simulation(scene, setting, {"cpu", 1}).advance({&traveller, 1}, duration);
  return traveller;
}

State resting(const Body& body, const Scene& scene) {
  State state;
  for (const Mass& mass : body.masses) state.position.push_back(mass.rest);
  state.velocity.resize(body.masses.size());
  return with_energy(body, state, scene);
}

State with_energy(const Body& body, State state, const Scene& scene) {
  state.start_energy = total_energy(body, state, scene);
  return state;
}

}  // namespace evodevo::tools::accuracy
