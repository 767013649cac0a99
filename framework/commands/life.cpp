// evodevo life: what development did to a robot, edit by edit.
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "archive.hpp"
#include "commands/options.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;
namespace po = boost::program_options;

/// Nothing where the operator did not ask for stress.
std::optional<float> seen(float stress) { return std::isnan(stress) ? std::nullopt : std::optional(stress); }

/// What happened to one mass or spring.
struct Event {
  std::uint32_t cycle = 0;
  std::string op;
  const char* what = "";              ///< "gone", "come" or "changed"
  std::vector<std::uint32_t> masses;  ///< the mass's number, or those of the two that the spring joins
  std::optional<float> stress;        ///< that the operator saw, N; only of springs that it names itself
  std::optional<Vec3> place;          ///< of a new mass, m
  std::optional<double> rest_length;  ///< of a spring that comes or changes, m
  std::optional<Material> material;   ///< likewise

  bool is_spring() const { return masses.size() == 2; }
};

/// A life as it goes on.
class Chronicle {
 public:
  Chronicle(Body born, std::vector<std::string> operators)
      : body_(std::move(born)), operators_(std::move(operators)), masses_(body_.masses.size()) {}

  void add(const Change& change) {
    const Edits& edits = change.edits;
    add_removals(change);
    for (std::size_t i = 0; i < edits.changed_springs.size(); ++i) {
      const ChangedSpring& spring = edits.changed_springs[i];
      Event& event = add_event(change, "changed", ends(spring.spring));
      event.stress = seen(change.changed_stress[i]);
      event.rest_length = spring.rest_length;
      event.material = spring.material;
    }
    for (const NewMass& mass : edits.new_masses) add_event(change, "come", {masses_.add()}).place = mass.place;
    for (const NewSpring& spring : edits.new_springs) {
      Event& event = add_event(change, "come", {number(spring.a), number(spring.b)});
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
    const std::string op = change.op ? operators_.at(*change.op) : "torn off";
    return events_.emplace_back(Event{.cycle = change.cycle, .op = op, .what = what, .masses = std::move(masses)});
  }

  void add_removals(const Change& change) {
    const Edits& edits = change.edits;
    std::map<std::uint32_t, std::optional<float>> gone;
    const auto goes = [&](std::uint32_t mass) {
      return std::binary_search(edits.removed_masses.begin(), edits.removed_masses.end(), mass);
    };
    for (std::uint32_t s = 0; s < body_.springs.size(); ++s)
      if (goes(body_.springs[s].a) || goes(body_.springs[s].b)) gone[s] = std::nullopt;
    for (std::size_t i = 0; i < edits.removed_springs.size(); ++i)
      gone[edits.removed_springs[i]] = seen(change.removed_stress[i]);
    for (const std::uint32_t mass : edits.removed_masses) add_event(change, "gone", {number(mass)});
    for (const auto& [spring, stress] : gone) add_event(change, "gone", ends(spring)).stress = stress;
  }

  std::vector<std::uint32_t> ends(std::uint32_t index) const {
    const Spring& spring = body_.springs.at(index);
    return {number(spring.a), number(spring.b)};
  }

  std::uint32_t number(std::uint32_t mass) const { return masses_.numbers().at(mass); }

  Body body_;
  std::vector<std::string> operators_;
  MassNumbers masses_;  ///< of `body_`
  std::vector<Event> events_;
};

Json to_json(const Event& event) {
  Json json = {{"cycle", event.cycle}, {"operator", event.op}, {"event", event.what}};
  if (event.is_spring())
    json["spring"] = event.masses;
  else
    json["mass"] = event.masses.front();
  if (event.stress) json["stress"] = *event.stress;
  if (event.place) json["position"] = {event.place->x, event.place->y, event.place->z};
  if (event.rest_length) json["rest_length"] = *event.rest_length;
  if (event.material)
    json["material"] = {{"stiffness", event.material->stiffness},
                        {"amplitude", event.material->amplitude},
                        {"frequency", event.material->frequency},
                        {"phase", event.material->phase}};
  return json;
}

void print(const Event& event) {
  const std::string who = event.is_spring()
                              ? "spring " + std::to_string(event.masses[0]) + "-" + std::to_string(event.masses[1])
                              : "mass " + std::to_string(event.masses[0]);
  std::printf("cycle %u  %s: %s %s", event.cycle, event.op.c_str(), who.c_str(), event.what);
  if (event.stress) std::printf(", stress %.4g N", static_cast<double>(*event.stress));
  if (event.place) std::printf(" at (%.4g, %.4g, %.4g) m", event.place->x, event.place->y, event.place->z);
  if (event.rest_length) std::printf(", rest length %.4g m", *event.rest_length);
  if (event.material)
    std::printf(", %.4g N/m, amplitude %.4g, %.4g Hz, phase %.4g", event.material->stiffness, event.material->amplitude,
                event.material->frequency, event.material->phase);
  std::printf("\n");
}

/// What the run has recorded of a life counts for more than what comes of living it again, perhaps elsewhere.
LifeRecord settled(const Archive& archive, std::uint32_t id, LifeRecord again, const std::string& device) {
  const std::optional<LifeRecord> recorded = archive.life(id);
  if (recorded && !(*recorded == again))
    std::cerr << "warning: lived again on " << device << ", individual " << id
              << " develops otherwise than in the run on " << archive.record("device")
              << "; these are the edits of the run\n";
  else if (!recorded && archive.record("device") != device)
    std::cerr << "warning: lived again on " << device << ", not on " << archive.record("device")
              << " as in the run, of which no edits are recorded; it may have developed otherwise\n";
  return recorded.value_or(std::move(again));
}

/// The life of an individual of a run.
class Biography {
 public:
  Biography(const Archive& archive, const ArchivedIndividual& individual,
            std::vector<std::filesystem::path> plugin_path)
      : individual_(individual) {
    Experiment experiment = recorded_experiment(archive, std::move(plugin_path));
    if (experiment.device == "cuda") experiment.device = "auto";  // there may be none here
    const auto simulator = make_simulator(experiment);
    const Evaluation evaluation(experiment, *simulator);
    const Newborn newborn{individual.id, individual.born, &individual_.genome};
    std::vector<Life> lives = evaluation.birth({&newborn, 1});
    born_ = lives.front().living.body;
    evaluation.develop(lives, [](double) {});
    const LifeRecord record = settled(archive, individual.id, lives.front().result.record, simulator->device());
    std::vector<std::string> operators;
    for (const OperatorUse& use : experiment.uses)
      if (use.kind == Devo::kind) operators.push_back(use.name);
    Chronicle chronicle(born_, std::move(operators));
    for (const Change& change : record.changes()) chronicle.add(change);
    matured_ = chronicle.body();
    events_ = chronicle.events();
  }

  void print() const {
    for (const Event& event : events_) evodevo::print(event);
    const Result& result = individual_.result;
    std::printf("individual %u: born with %zu masses and %zu springs, matured with %zu and %zu; %s%s\n", individual_.id,
                born_.masses.size(), born_.springs.size(), matured_.masses.size(), matured_.springs.size(),
                name(result.status), result.reason.empty() ? "" : (": " + result.reason).c_str());
  }

  Json json() const {
    Json edits = Json::array();
    for (const Event& event : events_) edits.push_back(to_json(event));
    return {{"individual", individual_.id},        {"status", name(individual_.result.status)},
            {"reason", individual_.result.reason}, {"born", counts(born_)},
            {"matured", counts(matured_)},         {"edits", std::move(edits)}};
  }

 private:
  static Json counts(const Body& body) { return {{"masses", body.masses.size()}, {"springs", body.springs.size()}}; }

  ArchivedIndividual individual_;
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
  const Biography biography(archive, chosen_individual(archive, *given), given_plugin_path(*given));
  if (given->contains("json"))
    std::cout << biography.json().dump(1) << '\n';
  else
    biography.print();
  return 0;
}

}  // namespace evodevo
