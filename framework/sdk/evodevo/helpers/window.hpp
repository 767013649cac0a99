// The keys `settle`, `window`, `rate` and `direction` of fitness operators.
#pragma once

#include <stdexcept>

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

/// In which direction a fitness operator measures a distance.
class MeasuredDirection {
 public:
  void declare(Parameters& p) {
    p.vector_or_choice(vector_, word_, "direction", {-1000, 1000, "1"}, {"any", "heading"},
                       "Direction in which the distance is measured: a vector of any length above 0; \"any\": from "
                       "start to end along the ground, wherever that leads; or \"heading\": along the ground, in the "
                       "direction in which the body moves in the first fifth of the window.");
  }

  /// Adds what is needed to a request for a window. Throws std::invalid_argument if the vector is 0.
  Request with_direction(Request request) const {
    if (word_.empty() && !(norm(vector_) > 0)) throw std::invalid_argument("direction must be longer than 0");
    if (word_ == "heading") {
      request.rate = 5 / request.window;
      request.channels.centre = true;
    }
    return request;
  }

  /// Returns the distance that the centre of mass has moved in the window, m.
  double distance(const Observation& observation) const {
    const Vec3 way = observation.centre_after - observation.centre_before;
    if (word_ == "any") return norm(along_ground(way));
    if (word_.empty()) return dot(way, vector_) / norm(vector_);
    const Vec3 heading = along_ground(observation.samples.centre(1) - observation.samples.centre(0));
    return norm(heading) == 0 ? 0 : dot(way, heading) / norm(heading);
  }

 private:
  static Vec3 along_ground(Vec3 way) { return {way.x, way.y, 0}; }

  Vec3 vector_ = {1, 0, 0};
  std::string word_;  ///< empty: the vector
};

}  // namespace evodevo
