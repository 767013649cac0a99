// Batches of bodies, and the time needed to simulate them.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/simulator.hpp"
#include "evodevo/body.hpp"
#include "settings.hpp"

namespace evodevo::tools::bench {

/// The median; for an even number of values, the upper of the two in the middle.
double median(std::vector<double> values);

/// Spring evaluations per second.
struct Rate {
  double whole = 0;   ///< based on the time of the whole call
  double device = 0;  ///< based on the time of the steps on the device; on the CPU the same as `whole`
};

/// A batch in our simulator. The given bodies are repeated cyclically until the batch has the size in the settings;
/// they must outlive the batch.
class Batch {
 public:
  Batch(const Settings& settings, std::span<const Body> bodies, const Scene& scene,
        Materials materials = Materials::table);

  std::string device() const { return simulator_->device(); }

  /// Simulates the batch from birth once, with samples of each body at `sampled_at`, and returns the rate. Throws
  /// std::runtime_error if a body diverges.
  Rate rate(Recording recording = {}, const std::vector<SamplePoint>& sampled_at = {});

 private:
  std::span<const Body> bodies_;
  Scene scene_;
  std::unique_ptr<Simulator> simulator_;
  std::vector<State> births_;
  std::vector<State> states_;
  std::uint64_t steps_;
};

}  // namespace evodevo::tools::bench
