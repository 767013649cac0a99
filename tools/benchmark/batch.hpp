// Batches of equal bodies and the time that it takes to move them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "evodevo/body.hpp"
#include "settings.hpp"
#include "simulator.hpp"

namespace evodevo::benchmark {

/// The middle one; of an even number, the upper of the two.
double median(std::vector<double> values);

/// Spring evaluations per second.
struct Rate {
  double whole = 0;   ///< of the whole call
  double device = 0;  ///< of the device's own time; the same on the CPU
};

/// A batch of equal bodies in our simulator. The body must outlive it.
class Batch {
 public:
  Batch(const Settings& settings, const Body& body, const Scene& scene);

  std::string device() const { return simulator_->device(); }

  /// The rate of one run from birth. Throws std::runtime_error where a body diverges.
  Rate rate(Recording recording = {});

 private:
  const Body& body_;
  Scene scene_;
  std::unique_ptr<Simulator> simulator_;
  State birth_;
  std::vector<State> states_;
  std::uint64_t steps_;
};

}  // namespace evodevo::benchmark
