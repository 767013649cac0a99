// A simulator for tests that pretends to run on another device.
#pragma once

#include <string>
#include <utility>

#include "support/lives.hpp"

namespace evodevo::testing {

/// The CPU simulator, with another device name.
class Elsewhere final : public AlteredSimulator {
 public:
  Elsewhere(const Experiment& experiment, std::string device)
      : AlteredSimulator(experiment), device_(std::move(device)) {}
  std::string device() const override { return device_; }

 private:
  std::string device_;
};

}  // namespace evodevo::testing
