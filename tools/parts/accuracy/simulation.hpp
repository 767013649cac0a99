// Bodies in our simulator and what it costs to move them.
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

/// How time is stepped.
struct Setting {
  Method method = Method::paper_euler;
  Precision precision = Precision::float32;
  double dt = 0.0005;  ///< s
};

std::string name(Precision precision);

std::vector<Method> all_methods();

/// Where bodies are moved.
struct Device {
  std::string name = "cpu";  ///< or "cuda"
  int threads = 0;           ///< of the host; 0: all cores

  /// In words, with the instruction set or the model.
  std::string description() const;
};

/// A body on its way.
struct Traveller {
  const Body* body = nullptr;
  State state;
  Status status = Status::ok;

  bool alive() const { return status == Status::ok; }
};

/// A scene with one way to step time. Bodies that have diverged stay where they are.
class Simulation {
 public:
  Simulation(const Scene& scene, const Setting& setting, const Device& device);

  /// Moves every body by the whole number of steps that is nearest to `duration` s. The seconds of computing: of all
  /// cores together, whatever else the machine does, or of the GPU for the steps alone.
  double advance(std::span<Traveller> travellers, double duration);

 private:
  Setting setting_;
  bool on_host_;
  std::unique_ptr<Simulator> simulator_;
};

/// One body alone on one core of this processor.
Traveller simulate(const Body& body, const State& start, const Scene& scene, const Setting& setting, double duration);

/// A body at its rest positions, at rest, its energy set.
State resting(const Body& body, const Scene& scene);

/// `state` with its energy set anew, after its velocities have been given.
State with_energy(const Body& body, State state, const Scene& scene);

}  // namespace evodevo::tools::accuracy
