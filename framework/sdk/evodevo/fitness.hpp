// Fitness operators: they score what a matured body did in the final evaluation.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "evodevo/operator.hpp"

namespace evodevo {

/// What a fitness operator needs to know about the final evaluation. A body first settles; then it is measured. The
/// time during which it is measured is the window.
struct Request {
  double settle = 0;   ///< time for which the body settles before the window opens, s
  double window = 10;  ///< length of the window, s
  bool work = false;   ///< whether Observation::work is needed
};

/// What one body did during its window.
struct Observation {
  Box box;             ///< bounding box of the body when the window opened, m
  Vec3 centre_before;  ///< centre of mass when the window opened, m
  Vec3 centre_after;   ///< centre of mass when the window closed, m
  double window = 0;   ///< length of the window, s
  double work = 0;     ///< sum of the positive work of each spring's muscle on the body, J; 0 if not requested
};

struct Objective {
  std::string name;
  std::string unit;
  bool maximise = true;
};

class Fitness : public Operator {
 public:
  static constexpr std::string_view kind = "fitness";

  /// Returns what score() needs to know.
  virtual Request observes() const = 0;
  virtual std::vector<Objective> objectives() const = 0;
  /// Returns one number for each objective. A number that is not finite makes the evaluation `invalid`.
  virtual std::vector<double> score(const Observation& observation) const = 0;
};

}  // namespace evodevo
