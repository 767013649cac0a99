// A simulator for tests that pretends to run on another device.
#pragma once

#include <string>
#include <utility>

#include "core/simulator.hpp"
#include "cpu/simulator.hpp"
#include "experiment/experiment.hpp"

namespace evodevo::testing {

/// The CPU simulator, with another device name.
class Elsewhere final : public Simulator {
 public:
  Elsewhere(const Experiment& experiment, std::string device)
      : simulator_(make_cpu_simulator(experiment.scene, experiment.stepping, 1)), device_(std::move(device)) {}

  void run(std::span<Task> tasks, Recording recording) override { simulator_->run(tasks, recording); }
  NeighbourSearch& neighbours() override { return simulator_->neighbours(); }
  Workers& workers() override { return simulator_->workers(); }
  std::string device() const override { return device_; }

 private:
  std::unique_ptr<Simulator> simulator_;
  std::string device_;
};

}  // namespace evodevo::testing
