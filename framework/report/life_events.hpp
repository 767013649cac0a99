// What happened in a life, event by event, as it is told to people.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "life/evaluation.hpp"

namespace evodevo {

/// A devo operator, as the events of a life describe it.
struct Narrated {
  std::string name;
  const Experiment* experiment = nullptr;
  std::size_t index = 0;    ///< among the experiment's devo operators
  bool is_tallied = false;  ///< whether stress is in points of skip-shift
  bool is_unique = true;    ///< among the names of the experiment's devo operators

  /// In what it measures the causes of a list of edits.
  Measure measure(Causes::List list) const;
};

/// Those of an experiment, which must outlive them.
std::vector<Narrated> narrated_operators(const Experiment& experiment);

/// The number that led to an edit.
struct Cause {
  Causes::List list;  ///< which says in what the operator measures
  double number;
};

/// What happened to one mass or spring, or to all springs that grow.
struct Event {
  std::uint32_t cycle = 0;
  std::optional<std::uint32_t> op;    ///< index among the devo operators; none: it was torn off
  const char* what = "";              ///< "gone", "come", "changed" or "growth"
  std::vector<std::uint32_t> masses;  ///< the mass's number, or those of the two that the spring joins; of growth none
  std::optional<Growth> growth;
  std::optional<Cause> cause;         ///< only of what the operator names itself
  std::optional<Vec3> position;       ///< of a new mass, m
  std::optional<double> rest_length;  ///< of a spring that comes or changes, m
  std::optional<Material> material;   ///< likewise

  bool is_spring() const { return masses.size() == 2; }
};

/// The events of a life.
struct LifeEvents {
  std::vector<Event> events;
  Body matured;  ///< what they made of the body
};

/// The events that made up the changes of a life which began with the body `born`.
LifeEvents life_events(const Body& born, const LifeRecord& record);

}  // namespace evodevo
