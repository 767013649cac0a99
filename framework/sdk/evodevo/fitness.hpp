// Fitness operators: they score what a body did in a window, after it has matured or within its life.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "evodevo/operator.hpp"
#include "evodevo/samples.hpp"

namespace evodevo {

/// What a fitness operator needs to know. A body first settles; then it is measured. The time during which it is
/// measured is the window. Both times are rounded to the nearest time step.
struct Request {
  double settle = 0;   ///< time for which the body settles before the window opens, s
  double window = 10;  ///< length of the window, s
  bool work = false;   ///< whether Observation::work is needed
  /// If given, the window lies within the life: the body begins to settle when development has changed it after this
  /// cycle, or at birth (0). The window must close before the last cycle ends. Otherwise the body begins to settle when
  /// it has matured, in every scenario. Windows within the life lie in the scenarios that develop or, if there are
  /// none, in the life in the experiment's own scene.
  std::optional<std::int64_t> cycle = std::nullopt;
  double rate = 0;         ///< samples per second; 0: none
  Channels channels = {};  ///< of each sample
};

/// A number that converts to double. Reading it throws a std::logic_error that names it unless it was requested.
class Requested {
 public:
  Requested() = default;
  Requested(double value) : value_(value), known_(true) {}  // NOLINT: converts on purpose

  operator double() const {
    if (!known_) throw std::logic_error("reads the work, which observes() does not ask for; set Request::work");
    return value_;
  }

 private:
  double value_ = 0;
  bool known_ = false;
};

/// What one body did during the window of an operator.
struct Observation {
  Box box;             ///< bounding box of the body when the window opened, m
  Vec3 centre_before;  ///< centre of mass when the window opened, m
  Vec3 centre_after;   ///< centre of mass when the window closed, m
  double window = 0;   ///< length of the window, s
  Requested work;      ///< sum of the positive work of each spring's muscle on the body, J; if requested
  Samples samples;     ///< if requested; empty otherwise
  /// The body when it had matured, after the changes of the scenario. Null in a window within the life.
  const Body* body = nullptr;
  /// Name of the scenario; empty if the experiment has none, and within the life in the experiment's own scene.
  std::string_view scenario;
  std::uint32_t life = 1;  ///< number of the life of the individual, from 1
};

/// What a score is for.
enum class Role : std::uint8_t {
  objective,   ///< selection makes it greater or smaller
  descriptor,  ///< says where an individual lies in the space of behaviours
  constraint,  ///< how far an individual is from feasible: one that is above 0 makes its evaluation `invalid`, and
               ///< selection sees only by how much (Candidate::violation)
  measure,     ///< is recorded, and never selected by
};

inline const char* name(Role role) {
  switch (role) {
    case Role::objective:
      return "objective";
    case Role::descriptor:
      return "descriptor";
    case Role::constraint:
      return "constraint";
    case Role::measure:
      return "measure";
  }
  return "?";
}

/// A score of a fitness operator.
struct Objective {
  std::string name;
  std::string unit;
  bool maximise = true;  ///< whether larger values are better; of an objective or a measure
  Role role = Role::objective;
  double low = 0, high = 1;  ///< the range of a descriptor, in its unit; values outside are allowed
  std::uint32_t bins = 10;   ///< number of cells of equal size into which maps divide this range; 1 to most_bins

  static constexpr std::uint32_t most_bins = 1000;

  /// Returns the cell of a descriptor's range in which a finite value lies, from 0. Values outside belong to the first
  /// or the last cell.
  std::uint32_t bin(double value) const {
    return static_cast<std::uint32_t>(std::clamp((value - low) / (high - low) * bins, 0.0, bins - 1.0));
  }
};

class Fitness : public Operator {
 public:
  static constexpr std::string_view kind = "fitness";

  /// Returns what score() needs to know.
  virtual Request observes() const = 0;
  /// Returns the scores that the operator gives: its objectives, or scores with other roles.
  virtual std::vector<Objective> objectives() const = 0;
  /// Returns one number for each of objectives(). It is called once for each scenario and repeat. A number that is not
  /// finite makes the evaluation `invalid`.
  virtual std::vector<double> score(const Observation& observation) const = 0;
};

}  // namespace evodevo
