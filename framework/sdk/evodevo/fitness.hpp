// Fitness: what a matured body did, as numbers.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "evodevo/operator.hpp"

namespace evodevo {

/// What the final evaluation has to show a fitness function; nothing else is recorded.
struct Request {
  double settle = 0;   ///< time before the window opens, s
  double window = 10;  ///< length of the window, s
  bool work = false;   ///< whether the muscles' work is needed
};

/// One body over its window.
struct Observation {
  Box box;             ///< around the body when the window opened, m
  Vec3 centre_before;  ///< centre of mass when the window opened, m
  Vec3 centre_after;   ///< centre of mass when it closed, m
  double window = 0;   ///< s
  double work = 0;     ///< work done by the muscles on the body, each spring's positive part, J; 0 if not requested
};

struct Objective {
  std::string name;
  std::string unit;
  bool maximise = true;
};

class Fitness : public Operator {
 public:
  static constexpr std::string_view kind = "fitness";

  virtual Request observes() const = 0;
  virtual std::vector<Objective> objectives() const = 0;
  /// One number for each objective. A number that is not finite makes the evaluation `invalid`.
  virtual std::vector<double> score(const Observation& observation) const = 0;
};

}  // namespace evodevo
