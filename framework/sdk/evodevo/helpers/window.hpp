// The keys `settle` and `window` of fitness operators.
#pragma once

#include "evodevo/fitness.hpp"

namespace evodevo {

/// When a fitness operator measures a body.
struct MeasuringWindow {
  double settle = 10;  ///< s
  double window = 10;  ///< s

  /// Declares `settle` and `window`.
  void declare(Parameters& p) {
    p.real(settle, "settle", {0, 3600, "s"}, "Time in which the body settles before it is measured.");
    p.real(window, "window", {0.001, 3600, "s"}, "Time in which the body is measured.");
  }

  /// Returns the request for this window without samples.
  Request request() const { return {.settle = settle, .window = window}; }

  /// Returns the request for this window with `rate` samples per second.
  Request request(double rate, const Channels& channels) const {
    return {.settle = settle, .window = window, .rate = rate, .channels = channels};
  }
};

}  // namespace evodevo
