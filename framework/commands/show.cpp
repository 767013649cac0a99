// evodevo show: what a run has come to.
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "archive.hpp"
#include "commands/options.hpp"
#include "commands/verification_report.hpp"
#include "evolution.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t best_shown = 5;
constexpr std::size_t generations_shown = 20;

/// An individual and its first parents, back to the random individual that it comes from.
std::vector<ArchivedIndividual> ancestry(const Archive& archive, std::uint32_t id) {
  std::vector<ArchivedIndividual> line;
  for (std::optional<std::uint32_t> next = id; next;) {
    line.push_back(archive.individual(*next).value());
    next = line.back().parents.empty() ? std::nullopt : std::optional(line.back().parents.front());
  }
  return line;
}

/// The age of its oldest genes when it was last in the population, generations.
std::uint32_t last_age(const ArchivedIndividual& individual, std::uint32_t last_generation) {
  return individual.age(individual.died.value_or(last_generation));
}

Json optional_json(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

class Report {
 public:
  explicit Report(const Archive& archive)
      : archive_(archive),
        objectives_(archive.objectives()),
        generations_(archive.generations()),
        last_generation_(generations_.empty() ? 0 : generations_.back().generation) {}

  Json json() const {
    const Experiment experiment = recorded_experiment(archive_);
    Json root = {{"folder", archive_.folder().string()},
                 {"experiment", archive_.record("name")},
                 {"seed", std::stoll(archive_.record("seed"))},
                 {"device", archive_.record("device")},
                 {"evodevo", archive_.record("evodevo")},
                 {"created", archive_.record("created")},
                 {"evaluations", done()},
                 {"evaluations_asked", experiment.evaluations},
                 {"finished", is_finished(experiment, generations_)},
                 {"statuses", archive_.statuses()}};
    root["objectives"] = Json::array();
    for (const Objective& o : objectives_)
      root["objectives"].push_back({{"name", o.name}, {"unit", o.unit}, {"maximise", o.maximise}});
    root["operators"] = Json::array();
    for (const OperatorUse& use : archive_.operators())
      root["operators"].push_back({{"kind", use.kind},
                                   {"name", use.name},
                                   {"version", use.version},
                                   {"file", use.file.string()},
                                   {"hash", use.hash}});
    root["generations"] = Json::array();
    for (const Summary& s : generations_)
      root["generations"].push_back({{"generation", s.generation},
                                     {"evaluations", s.evaluations},
                                     {"best", optional_json(s.best)},
                                     {"median", optional_json(s.median)},
                                     {"diverged", s.diverged},
                                     {"invalid", s.invalid},
                                     {"spring_evaluations", s.spring_evaluations},
                                     {"wall_time", s.wall_time}});
    const auto best = archive_.best(1);
    root["best"] = best.empty() ? Json(nullptr) : individual_json(best.front());
    return root;
  }

  void print() const {
    std::cout << archive_.record("name") << ", seed " << archive_.record("seed") << ", " << archive_.record("device")
              << ", evodevo " << archive_.record("evodevo") << ", begun " << archive_.record("created") << '\n';
    const auto statuses = archive_.statuses();
    std::cout << done() << " evaluations: " << statuses.at("ok") << " ok, " << statuses.at("invalid") << " invalid, "
              << statuses.at("diverged") << " diverged\n\n";
    print_generations();
    print_best();
  }

 private:
  std::int64_t done() const { return generations_.empty() ? 0 : generations_.back().evaluations; }

  Json individual_json(std::uint32_t id) const {
    const auto line = ancestry(archive_, id);
    const ArchivedIndividual& individual = line.front();
    Json objectives = Json::object();
    for (std::size_t i = 0; i < objectives_.size(); ++i)
      objectives[objectives_[i].name] = individual.result.objectives[i];
    Json ancestors = Json::array();
    for (std::size_t i = 1; i < line.size(); ++i) ancestors.push_back(line[i].id);
    const auto verification = archive_.verification(id);
    return {{"individual", individual.id},
            {"generation", individual.born},
            {"age", last_age(individual, last_generation_)},
            {"status", name(individual.result.status)},
            {"objectives", std::move(objectives)},
            {"parents", individual.parents},
            {"made_by", individual.made_by},
            {"ancestry", std::move(ancestors)},
            {"verification", verification ? to_json(*verification, objectives_.front()) : Json(nullptr)}};
  }

  void print_generations() const {
    std::printf("%10s %12s %10s %10s %9s %8s\n", "generation", "evaluations", "best", "median", "diverged", "invalid");
    const std::size_t stride = (generations_.size() + generations_shown - 1) / generations_shown;
    for (std::size_t i = 0; i < generations_.size(); ++i) {
      if (i % stride != 0 && i + 1 != generations_.size()) continue;
      const Summary& s = generations_[i];
      std::printf("%10u %12lld %10s %10s %9lld %8lld\n", s.generation, static_cast<long long>(s.evaluations),
                  number(s.best).c_str(), number(s.median).c_str(), static_cast<long long>(s.diverged),
                  static_cast<long long>(s.invalid));
    }
  }

  void print_best() const {
    std::printf("\nbest individuals\n");
    for (const std::uint32_t id : archive_.best(best_shown)) {
      const auto line = ancestry(archive_, id);
      const ArchivedIndividual& individual = line.front();
      std::printf("  %u: ", individual.id);
      for (std::size_t i = 0; i < objectives_.size(); ++i)
        std::printf("%s %s %s, ", objectives_[i].name.c_str(), number(individual.result.objectives[i]).c_str(),
                    objectives_[i].unit.c_str());
      std::printf("born in generation %u, age %u", individual.born, last_age(individual, last_generation_));
      if (const auto verification = archive_.verification(id))
        std::printf(", %s", marks_text(*verification, objectives_.front().maximise).c_str());
      std::printf("\n");
      std::string text;
      for (const ArchivedIndividual& ancestor : line) {
        if (!text.empty()) text += " < ";
        text += std::to_string(ancestor.id) + " (" + ancestor.made_by + ")";
      }
      std::printf("    %s\n", text.c_str());
    }
  }

  static std::string number(const std::optional<double>& value) {
    if (!value) return "-";
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", *value);
    return text;
  }

  const Archive& archive_;
  std::vector<Objective> objectives_;
  std::vector<Summary> generations_;
  std::uint32_t last_generation_;
};

}  // namespace

int show_command(const Arguments& arguments) {
  CommandLine line{"show DIR [--json]", {"DIR"}, {}};
  line.options.add_options()("json", "machine-readable, with every generation");
  const auto given = parse(std::move(line), arguments);
  if (!given) return 0;
  const Archive archive = Archive::read((*given)["DIR"].as<std::string>());
  const Report report(archive);
  if (given->contains("json"))
    std::cout << report.json().dump(1) << '\n';
  else
    report.print();
  return 0;
}

}  // namespace evodevo
