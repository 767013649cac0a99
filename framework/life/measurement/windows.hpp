// The windows of the fitness operators: when bodies are sampled, and which samples belong to which window.
#pragma once

#include <vector>

#include "experiment/experiment.hpp"
#include "life/life_simulation.hpp"

namespace evodevo {

/// The window of a fitness operator. Indices refer to the samples of the life if the window lies within the life, and
/// otherwise to the samples of a scenario.
struct Window {
  Request request;
  std::size_t opens = 0, closes = 0;      ///< the samples at the ends of the window
  std::vector<std::size_t> samples = {};  ///< the samples that the operator asks for

  bool within_life() const { return request.cycle.has_value(); }
};

/// The number of the last sample that a fitness operator asks for; the first one is 0.
std::int64_t last_sample(const Request& request);

/// The memory for the samples of the bodies that a cohort simulates at once, bytes. If they would take more, fewer
/// bodies are simulated at once, but at least one.
inline constexpr double most_sample_bytes = 4e9;

/// The times at which bodies are sampled for the windows of all fitness operators. A sample serves all operators that
/// ask for one at its time.
class Windows {
 public:
  /// The windows after maturing open `later` s later than the operators ask for.
  Windows(const Experiment& experiment, double later);

  /// One for each fitness operator.
  const std::vector<Window>& all() const { return windows_; }
  /// The samples in a cycle of development, from 1.
  Stretch in_cycle(std::int64_t cycle) const;
  /// The final evaluation and its samples. Its duration is 0 if all windows lie within the life.
  Stretch after_maturing() const;

  /// The memory that the samples of a body with so many masses and springs take after maturing, bytes.
  double bytes_after_maturing(std::size_t masses, std::size_t springs) const;
  /// The memory that they take within the life, bytes.
  double bytes_within_life(std::size_t masses, std::size_t springs) const;
  /// The number of lives, from the first one on, whose samples after maturing fit in memory together; at least one.
  std::size_t fitting_after_maturing(std::span<const Life> lives) const;
  /// The same for the samples within the lives, of bodies that keep their size, in all scenes in which they develop.
  std::size_t fitting_within_life(std::span<const Life> born) const;

 private:
  double cycle_time_;  // s
  std::vector<Window> windows_;
  std::vector<std::vector<SampleTime>> in_cycles_;  // samples of each cycle
  std::vector<SampleTime> after_maturing_;
  double duration_ = 0;  // of the final evaluation, s
  Channels counted_in_life_;
  double scenes_of_life_;  // number of scenes in which each newborn develops
};

}  // namespace evodevo
