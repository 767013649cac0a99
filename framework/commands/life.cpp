// evodevo life: tells how development changed a robot, cycle by cycle or edit by edit.
#include <fmt/ostream.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/json_text.hpp"
#include "base/text.hpp"
#include "commands/commands.hpp"
#include "commands/shell/options.hpp"
#include "commands/shell/output/notices.hpp"
#include "evolution/resimulation.hpp"
#include "report/life_events.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* by_none = "torn off";

Json to_json(const Event& event, const std::vector<Narrated>& operators) {
  Json json = {{"cycle", event.cycle}};
  json["operator"] = event.op ? operators.at(*event.op).name : by_none;
  if (event.op) json["operator_index"] = *event.op;
  json["event"] = event.what;
  if (event.is_spring())
    json["spring"] = event.masses;
  else if (!event.scaling)
    json["mass"] = event.masses.front();
  if (const auto& scaling = event.scaling) {
    json["by"] = operators.at(*event.op).remembered(scaling->number);
    json["from"] = scaling->from / scaling->whole;
    json["to"] = scaling->to / scaling->whole;
  }
  if (event.cause) {
    const Measure measure = operators.at(*event.op).measure(event.cause->kind);
    json["cause"] = event.cause->number;
    json["measure"] = measure.name;
    json["unit"] = measure.unit;
  }
  if (event.identity) json["identity"] = *event.identity;
  if (event.mother) json["mother"] = *event.mother;
  if (event.position) json["position"] = {event.position->x, event.position->y, event.position->z};
  if (event.rest_length) json["rest_length"] = *event.rest_length;
  if (event.material)
    json["material"] = {{"stiffness", event.material->stiffness},
                        {"amplitude", event.material->amplitude},
                        {"frequency", event.material->frequency},
                        {"phase", event.material->phase},
                        {"damping", event.material->damping}};
  if (event.stiffness) json["stiffness"] = *event.stiffness;
  return json;
}

/// Returns the mass or spring of an event as text, such as "mass 5" or, with the numbers of its masses, "spring 3-7".
std::string who(const Event& event) {
  if (event.is_spring()) return "spring " + std::to_string(event.masses[0]) + "-" + std::to_string(event.masses[1]);
  return "mass " + std::to_string(event.masses[0]);
}

void print(const Cause& cause, const Measure& measure) {
  const bool has_unit = measure.unit != "1" && std::isfinite(cause.number);
  std::cout << ", " << measure.name << ' ' << short_number(cause.number);
  if (has_unit) std::cout << ' ' << measure.unit;
}

/// Returns the beginning of a line, such as "cycle 3  spring-turnover: ".
std::string title_of(const Event& event, const std::vector<Narrated>& operators) {
  std::string title = by_none;
  if (event.op) title = operators.at(*event.op).name;
  if (event.op && !operators.at(*event.op).is_unique) title += fmt::format(" (operator {})", *event.op);
  return fmt::format("cycle {}  {}: ", event.cycle, title);
}

std::string scaling_text(const Event& event, const std::vector<Narrated>& operators) {
  const Scaling& scaling = *event.scaling;
  return fmt::format("rest lengths go from {:.4g} to {:.4g} of their \"{}\"", scaling.from / scaling.whole,
                     scaling.to / scaling.whole, operators.at(*event.op).remembered(scaling.number));
}

void print(const Event& event, const std::vector<Narrated>& operators) {
  const Narrated* op = event.op ? &operators.at(*event.op) : nullptr;
  std::cout << title_of(event, operators);
  if (event.scaling)
    std::cout << scaling_text(event, operators);
  else
    fmt::print(std::cout, "{} {}", who(event), event.what);
  if (event.mother) fmt::print(std::cout, ", a daughter of mass {}", *event.mother);
  if (event.cause) print(*event.cause, op->measure(event.cause->kind));
  if (const auto& at = event.position) fmt::print(std::cout, " at ({:.4g}, {:.4g}, {:.4g}) m", at->x, at->y, at->z);
  if (event.rest_length) fmt::print(std::cout, ", rest length {:.4g} m", *event.rest_length);
  if (const auto& material = event.material) {
    fmt::print(std::cout, ", {:.4g} N/m, amplitude {:.4g}, {:.4g} Hz, phase {:.4g}", material->stiffness,
               material->amplitude, material->frequency, material->phase);
    if (material->damping > 0) fmt::print(std::cout, ", damping {:.4g}", material->damping);
  }
  if (event.stiffness) fmt::print(std::cout, ", stiffness {:.4g} N/m", *event.stiffness);
  std::cout << '\n';
}

/// Edits of one kind that an operator made after one cycle.
class Group {
 public:
  explicit Group(const Event& first) : first_(first) {}

  bool takes(const Event& event) const {
    return event.cycle == first_.cycle && event.op == first_.op && event.is_spring() == first_.is_spring() &&
           event.scaling.has_value() == first_.scaling.has_value() && std::string_view(event.what) == first_.what;
  }
  void add(const Event& event) {
    ++count_;
    if (!event.cause || !std::isfinite(event.cause->number)) return;
    kind_ = event.cause->kind;
    causes_.push_back(event.cause->number);
  }
  const Event& first() const { return first_; }

  /// Returns a text such as "125 springs gone (stress 0.01 to 0.3 N)".
  std::string text(const std::vector<Narrated>& operators) const {
    if (first_.scaling) return scaling_text(first_, operators);
    std::string text = fmt::format("{} {}{} {}", count_, first_.is_spring() ? "spring" : "mass",
                                   count_ == 1 ? "" : (first_.is_spring() ? "s" : "es"), first_.what);
    if (causes_.empty()) return text;
    const Measure measure = operators.at(*first_.op).measure(*kind_);
    const auto [least, most] = std::minmax_element(causes_.begin(), causes_.end());
    text += " (" + measure.name + ' ' + short_number(*least);
    if (*most > *least) text += " to " + short_number(*most);
    return text + (measure.unit == "1" ? ")" : ' ' + measure.unit + ')');
  }

 private:
  Event first_;
  std::size_t count_ = 0;
  std::vector<double> causes_;    ///< those that are finite numbers
  std::optional<EditKind> kind_;  ///< of these; all edits of a group are of one kind
};

/// Prints a line for each operator and cycle.
void print_by_cycle(const std::vector<Event>& events, const std::vector<Narrated>& operators) {
  std::vector<Group> groups;
  const auto same_line = [](const Event& a, const Event& b) { return a.cycle == b.cycle && a.op == b.op; };
  const auto print_line = [&] {
    if (groups.empty()) return;
    std::vector<std::string> texts;
    for (const Group& group : groups) texts.push_back(group.text(operators));
    std::cout << title_of(groups.front().first(), operators) << joined(texts, ", ") << '\n';
    groups.clear();
  };
  for (const Event& event : events) {
    if (!groups.empty() && !same_line(groups.front().first(), event)) print_line();
    auto group = std::find_if(groups.begin(), groups.end(), [&](const Group& one) { return one.takes(event); });
    if (group == groups.end()) group = groups.emplace(groups.end(), event);
    group->add(event);
  }
  print_line();
}

/// The report on the life of an individual of a run. The constructor simulates the development again.
class LifeReport {
 public:
  LifeReport(const Archive& archive, const ArchivedIndividual& individual, const Given& given)
      : individual_(individual),
        experiment_(experiment_of_run(archive, given)),
        scenario_(given_developing_scenario(experiment_, given)),
        operators_(narrated_operators(experiment_)) {
    const auto simulator = opened_simulator(experiment_);
    const Evaluation evaluation(experiment_, *simulator);
    const Newborn newborn =
        given_life(for_resimulation(archive, experiment_, individual_, simulator->device()), experiment_, given);
    life_ = newborn.life;
    std::vector<Life> lives = evaluation.birth.of({&newborn, 1}, scenario_);
    const LivingBody newborn_body = lives.front().living;
    born_ = newborn_body.body;
    timed("simulating the development again", [&] { evaluation.development.run(lives, [](double) {}); });
    LifeEvents told = life_events(newborn_body, lives.front().record);
    matured_ = std::move(told.matured);
    events_ = std::move(told.events);
  }

  void print(bool every_edit) const {
    if (every_edit)
      for (const Event& event : events_) evodevo::print(event, operators_);
    else
      print_by_cycle(events_, operators_);
    const Result& result = individual_.result;
    fmt::print(std::cout, "individual {}: born with {} masses and {} springs, matured with {} and {}; {}{}\n",
               individual_.id, born_.masses.size(), born_.springs.size(), matured_.masses.size(),
               matured_.springs.size(), name(result.status), result.reason.empty() ? "" : ": " + result.reason);
    if (individual_.lives > 1) std::cout << "in life " << life_ << '\n';
    if (scenario_ != nullptr) std::cout << "in the scenario \"" << scenario_->name << "\"\n";
    switch (experiment_.development.control) {
      case Control::random_places:
        std::cout
            << "under the control \"random-places\": as many changes as each operator made, but at random places\n";
        break;
      case Control::shuffled_stress:
        std::cout
            << "under the control \"shuffled-stress\": the stress that caused an edit was measured at another spring\n";
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
            {"life", life_},
            {"scenario", scenario_ != nullptr ? Json(scenario_->name) : Json(nullptr)},
            {"control", name_of(experiment_.development.control)},
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
  const Scenario* scenario_;         ///< of `experiment_`, in which the life took place; null: its own scene
  std::vector<Narrated> operators_;  ///< devo operators of `experiment_`, to which they refer
  std::uint32_t life_ = 1;
  Body born_, matured_;
  std::vector<Event> events_;
};

int life(const Given& given) {
  const Archive archive = Archive::read(given["DIR"].as<std::string>());
  const LifeReport report(archive, chosen_individual(archive, given), given);
  if (given.contains("json"))
    std::cout << json_text(report.json()) << '\n';
  else
    report.print(given.contains("all"));
  return 0;
}

}  // namespace

Command life_command() {
  Options options;
  add_individual_option(options);
  add_life_option(options, "tell this life");
  options.add_options()("all", "print every edit instead of a summary of each cycle");
  options.add_options()("json", "print every edit as JSON");
  add_scenario_option(options, "tell the life in this scenario, in which robots develop");
  add_plugin_option(options);
  return {
      .name = "life",
      .arguments = {{"DIR"}},
      .summary = "Tell how the body of a robot developed",
      .text =
          {"It simulates the development again and prints how many masses and springs each operator added, changed or "
           "removed after each cycle, and because of which measured values. With --all it prints every single edit. "
           "Masses keep their numbers; a spring is named by the two masses that it joins."},
      .examples = {"life runs/quickstart-1", "life runs/quickstart-1 --all",
                   "life runs/quickstart-1 --individual 295 --json"},
      .options = options,
      .function = life};
}

}  // namespace evodevo
