#include "report/life_events.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "base/text.hpp"

namespace evodevo {
namespace {

/// Returns the cause of an edit, or nullopt if the operator gave none.
std::optional<Cause> cause_at(const Causes& causes, Causes::List list, std::size_t index) {
  const std::vector<double>& numbers = causes.*list;
  return numbers.empty() || std::isnan(numbers[index]) ? std::nullopt : std::optional(Cause{list, numbers[index]});
}

/// Collects the events of a life. Its changes must be added in the order in which they were made.
class EventLog {
 public:
  explicit EventLog(const LivingBody& born) : body_(born.body), masses_(born.numbers) {}

  void add(const Change& change) {
    const Edits& edits = change.edits;
    if (edits.growth) add_event(change, "growth", {}).growth = edits.growth;
    add_removals(change);
    for (std::size_t i = 0; i < edits.changed_springs.size(); ++i) {
      const ChangedSpring& spring = edits.changed_springs[i];
      Event& event = add_event(change, "changed", ends(spring.spring));
      event.cause = cause_at(edits.causes, &Causes::changed_springs, i);
      event.rest_length = spring.rest_length;
      event.material = spring.material;
      event.stiffness = stiffness_of(spring);
    }
    for (std::size_t i = 0; i < edits.new_masses.size(); ++i) {
      const NewMass& mass = edits.new_masses[i];
      Event& event = add_event(change, "come", {masses_.add(mass)});
      event.cause = cause_at(edits.causes, &Causes::new_masses, i);
      event.position = mass.position;
      event.identity = mass.identity;
      if (mass.mother) event.mother = number(*mass.mother);
    }
    for (std::size_t i = 0; i < edits.new_springs.size(); ++i) {
      const NewSpring& spring = edits.new_springs[i];
      Event& event = add_event(change, "come", {number(spring.a), number(spring.b)});
      event.cause = cause_at(edits.causes, &Causes::new_springs, i);
      event.rest_length = spring.rest_length;
      event.material = spring.material;
      if (spring.stiffness_factor != 1) event.stiffness = spring.stiffness_factor * spring.material.stiffness;
    }
    masses_.remove(edits.removed_masses);
    apply(change.edits, body_);
  }

  const Body& body() const { return body_; }
  const std::vector<Event>& events() const { return events_; }

 private:
  Event& add_event(const Change& change, const char* what, std::vector<std::uint32_t> masses) {
    return events_.emplace_back(
        Event{.cycle = change.cycle, .op = change.op, .what = what, .masses = std::move(masses)});
  }

  void add_removals(const Change& change) {
    const Edits& edits = change.edits;
    std::map<std::uint32_t, std::optional<Cause>> gone;
    const auto goes = [&](std::uint32_t mass) {
      return std::binary_search(edits.removed_masses.begin(), edits.removed_masses.end(), mass);
    };
    for (std::uint32_t s = 0; s < body_.springs.size(); ++s)
      if (goes(body_.springs[s].a) || goes(body_.springs[s].b)) gone[s] = std::nullopt;
    for (std::size_t i = 0; i < edits.removed_springs.size(); ++i)
      gone[edits.removed_springs[i]] = cause_at(edits.causes, &Causes::removed_springs, i);
    for (std::size_t i = 0; i < edits.removed_masses.size(); ++i) {
      Event& event = add_event(change, "gone", {number(edits.removed_masses[i])});
      event.cause = cause_at(edits.causes, &Causes::removed_masses, i);
      event.identity = masses_.identities().at(edits.removed_masses[i]);
    }
    for (const auto& [spring, cause] : gone) add_event(change, "gone", ends(spring)).cause = cause;
  }

  /// Returns the stiffness (N/m) of a spring to which a change gives a factor or, with a factor, a new material.
  std::optional<double> stiffness_of(const ChangedSpring& change) const {
    const Spring& spring = body_.springs.at(change.spring);
    const double factor = change.stiffness_factor.value_or(spring.stiffness_factor);
    if (!change.stiffness_factor && (!change.material || factor == 1)) return std::nullopt;
    return factor * change.material.value_or(body_.materials.at(spring.material)).stiffness;
  }

  std::vector<std::uint32_t> ends(std::uint32_t index) const {
    const Spring& spring = body_.springs.at(index);
    return {number(spring.a), number(spring.b)};
  }

  std::uint32_t number(std::uint32_t mass) const { return masses_.numbers().at(mass); }

  Body body_;
  MassNumbers masses_;  ///< numbers of the masses of `body_`
  std::vector<Event> events_;
};

}  // namespace

Measure Narrated::measure(Causes::List list) const {
  const Measure measure = call_operator(experiment->call_of(Devo::kind, index),
                                        [&] { return experiment->devo.at(index).op->measure(list); });
  if (is_tallied && measure.unit == "N") return {"skip-shift", "points"};
  return {printable(measure.name), printable(measure.unit)};
}

std::vector<Narrated> narrated_operators(const Experiment& experiment) {
  std::vector<Narrated> operators;
  for (const OperatorUse& use : experiment.uses) {
    if (use.kind != Devo::kind) continue;
    const std::size_t index = operators.size();
    const RecordRequest request = devo_request(experiment, index);
    const bool tallied = experiment.development.probe == Probe::skip_shift && (request.stress || request.load);
    Narrated& narrated = operators.emplace_back(
        Narrated{.name = use.name, .experiment = &experiment, .index = index, .is_tallied = tallied});
    for (Narrated& other : std::span(operators).first(operators.size() - 1))
      if (other.name == use.name) other.is_unique = narrated.is_unique = false;
  }
  return operators;
}

LifeEvents life_events(const LivingBody& born, const LifeRecord& record) {
  EventLog log(born);
  for (const Change& change : record.changes()) log.add(change);
  return {log.events(), log.body()};
}

}  // namespace evodevo
