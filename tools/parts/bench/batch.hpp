// Batches of bodies and the time that it takes to move them.
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

/// The middle one; of an even number, the upper of the two.
double median(std::vector<double> values);

/// Spring evaluations per second.
struct Rate {
  double whole = 0;   ///< of the whole call
  double device = 0;  ///< of the device's own time; the same on the CPU
};

/// A batch in our simulator, of one body after the other until there are as many as the settings say. They must outlive
/// it.
class Batch {
 public:
  Batch(const Settings& settings, std::span<const Body> bodies, const Scene& scene,
        Materials materials = Materials::table);

  std::string device() const { return simulator_->device(); }

  /// The rate of one run from birth. Throws std::runtime_error where a body diverges.
  Rate rate(Recording recording = {});

 private:
  std::span<const Body> bodies_;
  Scene scene_;
  std::unique_ptr<Simulator> simulator_;
  std::vector<State> births_;
  std::vector<State> states_;
  std::uint64_t steps_;
};

}  // namespace evodevo::tools::bench
