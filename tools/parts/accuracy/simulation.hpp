// Simulation of bodies, with its cost.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/method.hpp"
#include "core/scene.hpp"
#include "core/simulator.hpp"
#include "evodevo/body.hpp"

namespace evodevo::tools::accuracy {

/// How a simulation advances in time.
struct Setting {
  Method method = Method::paper_euler;
  Precision precision = Precision::float32;
  double dt = 0.0005;  ///< time step [s]
};

std::string name(Precision precision);

std::vector<Method> all_methods();

/// The device on which bodies are simulated.
struct Device {
  std::string name = "cpu";  ///< "cpu" or "cuda"
  int threads = 0;           ///< number of threads on the host; 0 means all cores

  /// A description of the device, with its instruction set or model.
  std::string description() const;
};

/// A body and its current state.
struct Traveller {
  const Body* body = nullptr;
  State state;
  Status status = Status::ok;

  bool alive() const { return status == Status::ok; }
};

/// A simulator of one scene with one setting. It does not advance bodies that have diverged.
class Simulation {
 public:
  Simulation(const Scene& scene, const Setting& setting, const Device& device);

  /// Advances every body by `duration` s, rounded to a whole number of steps. Returns the computing time, s: on the
  /// CPU, the processor time of all threads together, which does not count other programs; on the GPU, the time of the
  /// steps without copies.
  double advance(std::span<Traveller> travellers, double duration);

 private:
  Setting setting_;
  bool on_host_;
  std::unique_ptr<Simulator> simulator_;
};

/// Simulates a single body with one thread on the CPU.
Traveller simulate(const Body& body, const State& start, const Scene& scene, const Setting& setting, double duration);

/// The body at its rest positions with zero velocity; start_energy is set.
State resting(const Body& body, const Scene& scene);

/// Returns `state` with start_energy computed from its current positions and velocities.
State with_energy(const Body& body, State state, const Scene& scene);

}  // namespace evodevo::tools::accuracy
