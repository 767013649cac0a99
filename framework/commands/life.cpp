// evodevo life: what development did to a robot, edit by edit.
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <span>

#include "base/json_text.hpp"
#include "base/text.hpp"
#include "commands/options.hpp"
#include "evolution/resimulation.hpp"
#include "experiment/device.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;
namespace po = boost::program_options;

/// A devo operator as a life tells of it.
struct Narrated {
  std::string name;
  const Experiment* experiment = nullptr;
  std::size_t index = 0;    ///< among the experiment's devo operators
  bool is_tallied = false;  ///< whether stress is in points of skip-shift
  bool is_unique = true;    ///< among the names of the experiment's devo operators

  Measure measure(Causes::List list) const {
    const Measure measure = call_operator(*experiment, Devo::kind, index, {}, [&] {
      return experiment->development.operators.at(index).op->measure(list);
    });
    if (is_tallied && measure.unit == "N") return {"skip-shift", "points"};
    return {printable(measure.name), printable(measure.unit)};
  }
};

std::vector<Narrated> narrated_operators(const Experiment& experiment) {
  std::vector<Narrated> operators;
  for (const OperatorUse& use : experiment.uses) {
    if (use.kind != Devo::kind) continue;
    const std::size_t index = operators.size();
    const bool tallied = experiment.development.probe == Probe::skip_shift && devo_request(experiment, index).stress;
    Narrated& narrated = operators.emplace_back(
        Narrated{.name = use.name, .experiment = &experiment, .index = index, .is_tallied = tallied});
    for (Narrated& other : std::span(operators).first(operators.size() - 1))
      if (other.name == use.name) other.is_unique = narrated.is_unique = false;
  }
  return operators;
}

/// The number that led to an edit.
struct Cause {
  Causes::List list;  ///< which says in what the operator measures
  double number;
};

/// Nothing where there is no number.
std::optional<Cause> cause_at(const Causes& causes, Causes::List list, std::size_t index) {
  const std::vector<double>& numbers = causes.*list;
  return numbers.empty() || std::isnan(numbers[index]) ? std::nullopt : std::optional(Cause{list, numbers[index]});
}

/// What happened to one mass or spring, or to all springs that grow.
struct Event {
  std::uint32_t cycle = 0;
  std::optional<std::uint32_t> op;    ///< place among the devo operators; none: it was torn off
  const char* what = "";              ///< "gone", "come", "changed" or "growth"
  std::vector<std::uint32_t> masses;  ///< the mass's number, or those of the two that the spring joins; of growth none
  std::optional<Growth> growth;
  std::optional<Cause> cause;         ///< only of what the operator names itself
  std::optional<Vec3> place;          ///< of a new mass, m
  std::optional<double> rest_length;  ///< of a spring that comes or changes, m
  std::optional<Material> material;   ///< likewise

  bool is_spring() const { return masses.size() == 2; }
};

/// What happened in a life, as its changes are added in their order.
class EventLog {
 public:
  explicit EventLog(Body born) : body_(std::move(born)), masses_(body_.masses.size()) {}

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
    }
    for (std::size_t i = 0; i < edits.new_masses.size(); ++i) {
      Event& event = add_event(change, "come", {masses_.add()});
      event.cause = cause_at(edits.causes, &Causes::new_masses, i);
      event.place = edits.new_masses[i].place;
    }
    for (std::size_t i = 0; i < edits.new_springs.size(); ++i) {
      const NewSpring& spring = edits.new_springs[i];
      Event& event = add_event(change, "come", {number(spring.a), number(spring.b)});
      event.cause = cause_at(edits.causes, &Causes::new_springs, i);
      event.rest_length = spring.rest_length;
      event.material = spring.material;
    }
    masses_.remove(edits.removed_masses);
    replay(body_, change);
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
    for (std::size_t i = 0; i < edits.removed_masses.size(); ++i)
      add_event(change, "gone", {number(edits.removed_masses[i])}).cause =
          cause_at(edits.causes, &Causes::removed_masses, i);
    for (const auto& [spring, cause] : gone) add_event(change, "gone", ends(spring)).cause = cause;
  }

  std::vector<std::uint32_t> ends(std::uint32_t index) const {
    const Spring& spring = body_.springs.at(index);
    return {number(spring.a), number(spring.b)};
  }

  std::uint32_t number(std::uint32_t mass) const { return masses_.numbers().at(mass); }

  Body body_;
  MassNumbers masses_;  ///< of `body_`
  std::vector<Event> events_;
};

constexpr const char* by_none = "torn off";

Json to_json(const Event& event, const std::vector<Narrated>& operators) {
  Json json = {{"cycle", event.cycle}};
  json["operator"] = event.op ? operators.at(*event.op).name : by_none;
  if (event.op) json["operator_index"] = *event.op;
  json["event"] = event.what;
  if (event.is_spring())
    json["spring"] = event.masses;
  else if (!event.growth)
    json["mass"] = event.masses.front();
  if (const auto& growth = event.growth) {
    json["from"] = growth->from / growth->whole;
    json["to"] = growth->to / growth->whole;
  }
  if (event.cause) {
    const Measure measure = operators.at(*event.op).measure(event.cause->list);
    json["cause"] = event.cause->number;
    json["measure"] = measure.name;
    json["unit"] = measure.unit;
  }
  if (event.place) json["position"] = {event.place->x, event.place->y, event.place->z};
  if (event.rest_length) json["rest_length"] = *event.rest_length;
  if (event.material)
    json["material"] = {{"stiffness", event.material->stiffness},
                        {"amplitude", event.material->amplitude},
                        {"frequency", event.material->frequency},
                        {"phase", event.material->phase}};
  return json;
}

/// The mass or spring, by its numbers.
std::string who(const Event& event) {
  if (event.is_spring()) return "spring " + std::to_string(event.masses[0]) + "-" + std::to_string(event.masses[1]);
  return "mass " + std::to_string(event.masses[0]);
}

void print(const Cause& cause, const Measure& measure) {
  const bool has_unit = measure.unit != "1" && std::isfinite(cause.number);
  std::printf(", %s %s%s", measure.name.c_str(), short_number(cause.number).c_str(),
              has_unit ? (" " + measure.unit).c_str() : "");
}

void print(const Event& event, const std::vector<Narrated>& operators) {
  const Narrated* op = event.op ? &operators.at(*event.op) : nullptr;
  const std::string title =
      op == nullptr ? by_none : op->name + (op->is_unique ? "" : " (operator " + std::to_string(*event.op) + ")");
  std::printf("cycle %u  %s: ", event.cycle, title.c_str());
  if (const auto& growth = event.growth)
    std::printf("springs grow from %.4g to %.4g of their way", growth->from / growth->whole,
                growth->to / growth->whole);
  else
    std::printf("%s %s", who(event).c_str(), event.what);
  if (event.cause) print(*event.cause, op->measure(event.cause->list));
  if (event.place) std::printf(" at (%.4g, %.4g, %.4g) m", event.place->x, event.place->y, event.place->z);
  if (event.rest_length) std::printf(", rest length %.4g m", *event.rest_length);
  if (event.material)
    std::printf(", %.4g N/m, amplitude %.4g, %.4g Hz, phase %.4g", event.material->stiffness, event.material->amplitude,
                event.material->frequency, event.material->phase);
  std::printf("\n");
}

/// What is told of an individual of a run: its life, lived again.
class LifeReport {
 public:
  LifeReport(const Archive& archive, const ArchivedIndividual& individual,
             std::vector<std::filesystem::path> plugin_path)
      : individual_(individual),
        experiment_(experiment_to_live_again(archive, std::move(plugin_path))),
        operators_(narrated_operators(experiment_)) {
    const auto simulator = make_simulator(experiment_);
    const Evaluation evaluation(experiment_, *simulator);
    const Newborn newborn = born_again(archive, experiment_, individual_, simulator->device());
    std::vector<Life> lives = evaluation.birth({&newborn, 1});
    born_ = lives.front().living.body;
    evaluation.develop(lives, [](double) {});
    EventLog log(born_);
    for (const Change& change : lives.front().result.record.changes()) log.add(change);
    matured_ = log.body();
    events_ = log.events();
  }

  void print() const {
    for (const Event& event : events_) evodevo::print(event, operators_);
    const Result& result = individual_.result;
    std::printf("individual %u: born with %zu masses and %zu springs, matured with %zu and %zu; %s%s\n", individual_.id,
                born_.masses.size(), born_.springs.size(), matured_.masses.size(), matured_.springs.size(),
                name(result.status), result.reason.empty() ? "" : (": " + result.reason).c_str());
    switch (experiment_.development.control) {
      case Control::random_places:
        std::printf("under the control \"random-places\": each operator's changes, but anywhere\n");
        break;
      case Control::shuffled_stress:
        std::printf("under the control \"shuffled-stress\": what caused an edit was measured at another spring\n");
        break;
      default:
        break;
    }
  }

  Json json() const {
    Json operators = Json::array(), edits = Json::array();
    for (const Narrated& op : operators_) operators.push_back({{"name", op.name}});
    for (const Event& event : events_) edits.push_back(to_json(event, operators_));
    return {{"individual", individual_.id},
            {"control", name(experiment_.development.control)},
            {"status", name(individual_.result.status)},
            {"reason", individual_.result.reason},
            {"born", counts(born_)},
            {"matured", counts(matured_)},
            {"operators", std::move(operators)},
            {"edits", std::move(edits)}};
  }

 private:
  static Json counts(const Body& body) { return {{"masses", body.masses.size()}, {"springs", body.springs.size()}}; }

  ArchivedIndividual individual_;
  Experiment experiment_;
  std::vector<Narrated> operators_;  ///< of `experiment_`
  Body born_, matured_;
  std::vector<Event> events_;
};

}  // namespace

int life_command(const Arguments& arguments) {
  CommandLine line{"life DIR [--individual ID] [--json] [--plugin-path P]", {"DIR"}, {}};
  line.options.add_options()("individual", po::value<std::int64_t>(), "its id; default: the best")("json",
                                                                                                   "machine-readable");
  add_plugin_option(line.options);
  const auto given = parse(std::move(line), arguments);
  if (!given) return 0;
  const Archive archive = Archive::read((*given)["DIR"].as<std::string>());
  const LifeReport report(archive, chosen_individual(archive, *given), given_plugin_path(*given));
  if (given->contains("json"))
    std::cout << json_text(report.json()) << '\n';
  else
    report.print();
  return 0;
}

}  // namespace evodevo
