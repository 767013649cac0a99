// The keys `settle`, `window` and `rate` of fitness operators.
#pragma once

#include "evodevo/fitness.hpp"

namespace evodevo {

/// When a fitness operator measures a body.
struct MeasuringWindow {
  double settle = 10;  ///< s
  double window = 10;  ///< s
  double rate = 10;    ///< samples per second, of operators that ask for samples

  /// Declares `settle` and `window`.
  void declare(Parameters& p) {
    p.real(settle, "settle", {0, 3600, "s"}, "Time in which the body settles before it is measured.");
    p.real(window, "window", {0.001, 3600, "s"}, "Time in which the body is measured.");
  }

  /// Declares `settle`, `window` and `rate`, with at least one sample after that at the opening of the window.
  void declare_sampled(Parameters& p) {
    declare(p);
    p.real(rate, "rate", {0.01, 1000, "1/s"}, "Number of times per second at which the body is sampled.");
    p.require(rate * window >= 1, "rate", "expected one or more samples within the window");
  }

  /// Returns the request for this window without samples.
  Request request() const { return {.settle = settle, .window = window}; }

  /// Returns the request for this window with samples.
  Request request(const Channels& channels) const {
    return {.settle = settle, .window = window, .rate = rate, .channels = channels};
  }
};

}  // namespace evodevo
