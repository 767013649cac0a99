// The edits of a life as a list of events for people to read.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "life/evaluation.hpp"

namespace evodevo {

/// A devo operator, with what is needed to describe its edits.
struct Narrated {
  std::string name;
  const Experiment* experiment = nullptr;
  std::size_t index = 0;    ///< index among the experiment's devo operators
  bool is_tallied = false;  ///< whether the operator sees stress as Skip-Shift points instead of in N
  bool is_unique = true;    ///< whether no other devo operator of the experiment has this name

  /// Returns the name and unit of the causes of a kind of edit.
  Measure measure(EditKind kind) const;
  /// Returns the name of a number that the operator remembers about springs.
  std::string remembered(std::uint32_t number) const;
};

/// Returns the devo operators of an experiment. They refer to the experiment, which must outlive them.
std::vector<Narrated> narrated_operators(const Experiment& experiment);

/// The number that caused an edit.
struct Cause {
  EditKind kind;  ///< of the edit; it determines the name and unit of the number
  double number;
};

/// One edit of a mass or spring, or the scaling of all rest lengths.
struct Event {
  std::uint32_t cycle = 0;            ///< cycle after which the edit was made
  std::optional<std::uint32_t> op;    ///< index among the devo operators; none: removed with a loose piece of the body
  const char* what = "";              ///< "gone", "come", "changed" or "scaled"
  std::vector<std::uint32_t> masses;  ///< number of the mass, or of the two masses of the spring; empty if scaled
  std::optional<Scaling> scaling;
  std::optional<Cause> cause;             ///< cause, if the operator requested this edit itself and gave a cause
  std::optional<Vec3> position;           ///< position of a new mass, m
  std::optional<std::uint64_t> identity;  ///< of a mass (DevoContext::identity())
  std::optional<std::uint32_t> mother;    ///< number of the mass from which a new mass descends
  std::optional<double> rest_length;      ///< rest length of a new spring, or the new one of a changed spring, m
  std::optional<Material> material;       ///< material of a new spring, or the new one of a changed spring
  std::optional<double> stiffness;        ///< new stiffness of a spring that does not have that of its material, N/m

  bool is_spring() const { return masses.size() == 2; }
};

/// The events of a life.
struct LifeEvents {
  std::vector<Event> events;
  Body matured;  ///< body after all events
};

/// Returns the events of a life. `born` is the body at birth.
LifeEvents life_events(const LivingBody& born, const LifeRecord& record);

}  // namespace evodevo
