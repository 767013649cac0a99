#include "report/life_events.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "base/text.hpp"

namespace evodevo {
namespace {

/// Returns the cause of an edit, or nullopt if the operator gave none.
std::optional<Cause> cause_of(EditKind kind, double cause) {
  return std::isnan(cause) ? std::nullopt : std::optional(Cause{kind, cause});
}

/// Collects the events of a life. Its changes must be added in the order in which they were made.
class EventLog {
 public:
  explicit EventLog(const LivingBody& born) : living_(born), body_(living_.body), masses_(born.numbers) {}

  void add(const Change& change) {
    const Edits& edits = change.edits;
    if (edits.scaling) add_event(change, "scaled", {}).scaling = edits.scaling;
    add_removals(change);
    for (const ChangedSpring& spring : edits.changed_springs) {
      Event& event = add_event(change, "changed", ends(spring.spring));
      event.cause = cause_of(EditKind::changed_spring, spring.cause);
      event.rest_length = spring.rest_length;
      event.material = spring.material;
      event.stiffness = stiffness_of(spring);
    }
    for (const NewMass& mass : edits.new_masses) {
      Event& event = add_event(change, "come", {masses_.add(mass)});
      event.cause = cause_of(EditKind::new_mass, mass.cause);
      event.position = mass.position;
      event.identity = mass.identity;
      if (mass.mother) event.mother = number(*mass.mother);
    }
    for (const NewSpring& spring : edits.new_springs) {
      Event& event = add_event(change, "come", {number(spring.a), number(spring.b)});
      event.cause = cause_of(EditKind::new_spring, spring.cause);
      event.rest_length = spring.rest_length;
      event.material = spring.material;
      if (spring.stiffness_factor != 1) event.stiffness = spring.stiffness_factor * spring.material.stiffness;
    }
    masses_.remove(edits.removed_masses);
    apply(change.edits, living_, change.op);
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
      return std::ranges::binary_search(edits.removed_masses, mass, {}, &Removal::index);
    };
    for (std::uint32_t s = 0; s < body_.springs.size(); ++s)
      if (goes(body_.springs[s].a) || goes(body_.springs[s].b)) gone[s] = std::nullopt;
    for (const auto& [spring, cause] : edits.removed_springs) gone[spring] = cause_of(EditKind::removed_spring, cause);
    for (const auto& [mass, cause] : edits.removed_masses) {
      Event& event = add_event(change, "gone", {number(mass)});
      event.cause = cause_of(EditKind::removed_mass, cause);
      event.identity = masses_.identities().at(mass);
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

  LivingBody living_;
  const Body& body_;    ///< of `living_`
  MassNumbers masses_;  ///< numbers of the masses of `body_`
  std::vector<Event> events_;
};

}  // namespace

Measure Narrated::measure(EditKind kind) const {
  const Measure measure = call_operator(experiment->call_of(Devo::kind, index),
                                        [&] { return experiment->devo.at(index).op->measure(kind); });
  if (is_tallied && measure.unit == "N") return {"skip-shift", "points"};
  return {printable(measure.name), printable(measure.unit)};
}

std::string Narrated::remembered(std::uint32_t number) const {
  return printable(memory_names(*experiment, index).springs.at(number));
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
