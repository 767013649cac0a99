// evodevo show: what a run has come to.
#include <algorithm>
#include <cstdio>
#include <iostream>

#include "base/json_text.hpp"
#include "base/text.hpp"
#include "commands/commands.hpp"
#include "commands/shell/options.hpp"
#include "evolution/archive/archive.hpp"
#include "experiment/toml_reader.hpp"
#include "report/run_json.hpp"

namespace evodevo {
namespace {

constexpr std::size_t best_shown = 5;
constexpr std::size_t generations_shown = 20;

class Report {
 public:
  explicit Report(const Archive& archive)
      : archive_(archive),
        objectives_(archive.objectives()),
        generations_(archive.generations()),
        last_generation_(generations_.empty() ? 0 : generations_.back().generation) {}

  void print() const {
    const auto recorded = [&](const char* key) { return printable(archive_.record(key)); };
    std::cout << recorded("name") << ", seed " << recorded("seed") << ", " << devices() << ", evodevo "
              << recorded("evodevo") << ", begun " << recorded("created") << '\n';
    const auto statuses = archive_.statuses();
    if (const Control control = recorded_settings(archive_).development.control; control != Control::off)
      std::cout << "development under the control \"" << name_of(control) << "\"\n";
    std::cout << done() << " evaluations: " << statuses.at("ok") << " ok, " << statuses.at("invalid") << " invalid, "
              << statuses.at("diverged") << " diverged; " << clones(generations_) << " of them clones\n\n";
    print_generations();
    print_failures();
    print_best();
  }

 private:
  std::int64_t done() const { return generations_.empty() ? 0 : generations_.back().evaluations; }

  /// In the order in which they came.
  std::string devices() const {
    std::vector<std::string> devices;
    for (const Provenance& provenance : archive_.provenances())
      if (std::find(devices.begin(), devices.end(), provenance.device) == devices.end())
        devices.push_back(provenance.device);
    return joined(devices, ", then ");
  }

  void print_generations() const {
    std::printf("%10s %12s %10s %10s %9s %8s %7s\n", "generation", "evaluations", "best", "median", "diverged",
                "invalid", "clones");
    const std::size_t stride = (generations_.size() + generations_shown - 1) / generations_shown;
    for (std::size_t i = 0; i < generations_.size(); ++i) {
      if (i % stride != 0 && i + 1 != generations_.size()) continue;
      const Summary& s = generations_[i];
      std::printf("%10u %12lld %10s %10s %9lld %8lld %7lld\n", s.generation, static_cast<long long>(s.evaluations),
                  number(s.best).c_str(), number(s.median).c_str(), static_cast<long long>(s.diverged),
                  static_cast<long long>(s.invalid), static_cast<long long>(s.clones));
    }
  }

  void print_failures() const {
    const std::vector<Failure> failures = archive_.failures();
    if (!failures.empty()) std::printf("\nwithout a fitness\n");
    for (const Failure& failure : failures)
      std::printf("  %lld %s: %s%s\n", static_cast<long long>(failure.count), failure.status.c_str(),
                  failure.reason.c_str(), failure.varies ? ", or the like" : "");
  }

  void print_best() const {
    if (archive_.best(1).empty()) return;
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

  static std::string number(const std::optional<double>& value) { return value ? short_number(*value) : "-"; }

  const Archive& archive_;
  std::vector<Objective> objectives_;
  std::vector<Summary> generations_;
  std::uint32_t last_generation_;
};

int show(const Given& given) {
  const Archive archive = Archive::read(given["DIR"].as<std::string>());
  if (given.contains("json"))
    std::cout << json_text(run_json(archive, recorded_settings(archive))) << '\n';
  else
    Report(archive).print();
  return 0;
}

}  // namespace

Command show_command() {
  Options options;
  options.add_options()("json", "print JSON, with every generation");
  return {.name = "show",
          .arguments = {{"DIR"}},
          .summary = "Show the progress and the best robots of a run",
          .text = {"It prints the best and the median fitness by generation, why individuals have no fitness, and the "
                   "best individuals with their ancestors. The run may be going on at the same time."},
          .examples = {"show runs/quickstart-1", "show runs/quickstart-1 --json"},
          .options = options,
          .function = show};
}

}  // namespace evodevo
