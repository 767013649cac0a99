// evodevo show: prints the state of a run.
#include <fmt/ostream.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <numeric>
#include <set>

#include "archive/archive.hpp"
#include "archive/island_folders.hpp"
#include "archive/recorded_experiment.hpp"
#include "base/json_text.hpp"
#include "base/statistics.hpp"
#include "base/text.hpp"
#include "commands/commands.hpp"
#include "commands/shell/options.hpp"
#include "commands/shell/output/notices.hpp"
#include "experiment/toml_reader.hpp"
#include "report/diversity.hpp"
#include "report/lineage.hpp"
#include "report/run_json.hpp"
#include "report/signal.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t best_shown = 5;
constexpr std::size_t best_of_others_shown = 1;  ///< by each objective after the first
constexpr std::size_t generations_shown = 20;

/// The progress in an objective, as two columns of a table: the best and the median.
struct Column {
  std::string head;
  std::size_t width;  ///< of the best
  std::vector<BestAndMedian> progress;
};

/// Returns a text such as: reach (m), lower is better.
std::string head_of(const Objective& objective) {
  const bool has_unit = !objective.unit.empty() && objective.unit != "1";
  return objective.name + (has_unit ? " (" + objective.unit + ")" : "") +
         (objective.maximise ? "" : ", lower is better");
}

class Report {
 public:
  explicit Report(const Archive& archive)
      : archive_(archive),
        objectives_(archive.objectives()),
        layout_(archive.layout()),
        generations_(archive.generations()),
        map_(niche_map(archive)),
        last_generation_(generations_.empty() ? 0 : generations_.back().generation) {
    constexpr std::size_t narrowest = 10, of_median = 11, gap = 2;
    for (std::size_t k = 0; k < objectives_.size(); ++k) {
      const std::string head = objectives_.size() > 1 ? head_of(objectives_[k]) : "";
      columns_.push_back({head, std::max(narrowest + of_median, head.size() + gap) - of_median,
                          progress_in(archive, generations_, k)});
    }
  }

  void print() const {
    const auto recorded = [&](const char* key) { return printable(archive_.record(key)); };
    std::cout << recorded("name") << ", seed " << recorded("seed") << ", " << devices() << ", evodevo "
              << recorded("evodevo") << ", begun " << recorded("created") << '\n';
    print_island();
    const auto statuses = archive_.statuses();
    if (const Control control = recorded_settings(archive_).development.control; control != Control::off)
      std::cout << "development under the control \"" << name_of(control) << "\"\n";
    std::cout << done() << " evaluations: " << statuses.at("ok") << " ok, " << statuses.at("invalid") << " invalid, "
              << statuses.at("diverged") << " diverged";
    if (has_refusals())
      std::cout << ", " << statuses.at("artefact") << " artefact, " << statuses.at("lucky") << " lucky, "
                << statuses.at("passive") << " passive";
    std::cout << "; " << clones(generations_) << " of them clones\n\n";
    print_generations();
    print_diversity();
    print_failures();
    print_best();
  }

  void print_individual(std::uint32_t id) const {
    const auto line = ancestry(archive_, id);
    const ArchivedIndividual& individual = line.front();
    fmt::print(std::cout, "  {}: ", individual.id);
    if (individual.result.status != Status::ok)
      fmt::print(std::cout, "{}, {}, ", name(individual.result.status), individual.result.reason);
    for (std::size_t i = 0; i < individual.result.objectives.size(); ++i)
      fmt::print(std::cout, "{} {}, ", objectives_[i].name,
                 short_quantity(individual.result.objectives[i], objectives_[i].unit));
    fmt::print(std::cout, "born in generation {}, age {}", individual.born, last_age(individual, last_generation_));
    if (const auto verification = archive_.verification(id))
      std::cout << ", " << verdict_text(*verification, objectives_.front().maximise);
    std::cout << '\n';
    print_lives(individual.result.lives);
    print_measures(id);
    const std::vector<ArchivedTest> tests = archive_.tests(id);
    for (const Objective& objective : objectives_) print_tests(tests, objective);
    std::cout << "    " << line_text(line) << '\n';
  }

 private:
  void print_island() const {
    const std::int64_t number = archive_.island();
    const Settings settings = recorded_settings(archive_);
    if (number == 0 || !settings.islands) return;
    const IslandSettings& islands = *settings.islands;
    const std::vector<Immigrant> immigrants = archive_.immigrants();
    const auto living = std::ranges::count_if(immigrants, [](const Immigrant& one) { return !one.died; });
    std::cout << "island " << number << " of " << islands.count << ", topology " << name_of(islands.topology) << ", "
              << immigrants.size() << " immigrants, of which " << living << " live\n";
  }

  bool has_refusals() const {
    return std::ranges::any_of(generations_, [](const Summary& s) { return s.refused() > 0; });
  }

  std::int64_t done() const { return generations_.empty() ? 0 : generations_.back().evaluations; }

  /// Returns the devices that have evaluated individuals, in the order in which they came to the run. If there are
  /// several, each comes with its number of evaluations.
  std::string devices() const {
    const std::vector<Provenance> provenances = archive_.provenances();
    const std::vector<std::int64_t> evaluated = archive_.evaluated_by_provenance();
    std::vector<std::pair<std::string, std::int64_t>> devices;
    for (std::size_t i = 0; i < provenances.size(); ++i) {
      if (evaluated[i] == 0) continue;
      const std::string& device = provenances[i].device;
      auto known = std::ranges::find(devices, device, &std::pair<std::string, std::int64_t>::first);
      if (known == devices.end()) known = devices.insert(known, {device, 0});
      known->second += evaluated[i];
    }
    if (devices.empty()) return provenances.front().device;
    if (devices.size() == 1) return devices.front().first;
    std::vector<std::string> texts;
    for (const auto& [device, count] : devices)
      texts.push_back(device + " (evaluations: " + std::to_string(count) + ")");
    return joined(texts);
  }

  void print_generations() const {
    if (objectives_.size() > 1) print_objective_heads();
    fmt::print(std::cout, "{:>10} {:>12}", "generation", "evaluations");
    for (const Column& column : columns_) fmt::print(std::cout, " {:>{}} {:>10}", "best", column.width, "median");
    if (!map_.axes.empty()) fmt::print(std::cout, " {:>8} {:>10}", "coverage", "QD score");
    fmt::print(std::cout, " {:>9} {:>8}", "diverged", "invalid");
    if (has_refusals()) fmt::print(std::cout, " {:>8} {:>6} {:>8}", "artefact", "lucky", "passive");
    fmt::print(std::cout, " {:>7}\n", "clones");
    const std::size_t stride = (generations_.size() + generations_shown - 1) / generations_shown;
    for (std::size_t i = 0; i < generations_.size(); ++i)
      if (i % stride == 0 || i + 1 == generations_.size()) print_generation(i);
  }

  /// Prints the name of each objective above its columns.
  void print_objective_heads() const {
    fmt::print(std::cout, "{:23}", "");
    for (const Column& column : columns_) fmt::print(std::cout, " {:>{}}", column.head, column.width + 11);
    std::cout << '\n';
  }

  void print_generation(std::size_t i) const {
    const Summary& s = generations_[i];
    fmt::print(std::cout, "{:>10} {:>12}", s.generation, s.evaluations);
    for (const Column& column : columns_)
      fmt::print(std::cout, " {:>{}} {:>10}", number(column.progress[i].best), column.width,
                 number(column.progress[i].median));
    if (!map_.axes.empty()) {
      const MapState& state = map_.history.at(i);
      fmt::print(std::cout, " {:>8} {:>10}", percent(map_.coverage(state)), number(map_.qd_score(state)));
    }
    fmt::print(std::cout, " {:>9} {:>8}", s.diverged, s.invalid);
    if (has_refusals()) fmt::print(std::cout, " {:>8} {:>6} {:>8}", s.artefact, s.lucky, s.passive);
    fmt::print(std::cout, " {:>7}\n", s.clones);
  }

  /// Prints how many niches are filled, and what selection has noted about the living.
  void print_diversity() const {
    if (generations_.empty()) return;
    std::vector<std::string> lines;
    if (!map_.axes.empty()) {
      std::vector<std::string> axes;
      for (const Objective& axis : map_.axes) axes.push_back(axis.name);
      lines.push_back(
          fmt::format("{} of {} niches filled, by {}", map_.elites.size(), map_.cells(), joined(axes, " and ")));
    }
    for (const NoteHistory& history : archive_.note_histories())
      if (!history.living.back().empty()) lines.push_back(noted_text(history.title, history.living.back()));
    if (!lines.empty()) std::cout << "\ndiversity\n";
    for (const std::string& line : lines) std::cout << "  " << line << '\n';
  }

  /// Returns a text such as: 3 different values of species among the living; or: novelty of the living: at most 0.31,
  /// median 0.2.
  static std::string noted_text(const NoteTitle& title, const std::vector<double>& values) {
    const std::size_t different = std::set(values.begin(), values.end()).size();
    if (title.is_label)
      return fmt::format("{} different value{} of {} among the living", different, different == 1 ? "" : "s",
                         title.name);
    const std::string what = title.name + " of the living: ";
    const auto [greatest, median] = best_and_median(values, true);
    return what + "at most " + short_quantity(*greatest, title.unit) + ", median " +
           short_quantity(*median, title.unit);
  }

  void print_failures() const {
    const std::vector<Failure> failures = archive_.failures();
    if (!failures.empty()) std::cout << "\nwithout a fitness\n";
    for (const Failure& failure : failures)
      fmt::print(std::cout, "  {} {}: {}{}\n", failure.count, failure.status, failure.reason,
                 failure.varies ? ", or the like" : "");
  }

  void print_best() const {
    for (std::size_t k = 0; k < objectives_.size(); ++k) {
      const std::vector<std::uint32_t> best = archive_.best(k == 0 ? best_shown : best_of_others_shown, k);
      if (best.empty()) return;
      std::cout << "\nbest individuals" << (objectives_.size() > 1 ? " in " + objectives_[k].name : "") << '\n';
      for (const std::uint32_t id : best) print_individual(id);
    }
  }

  /// Prints the scores that are not objectives, and what the selection operator has noted.
  void print_measures(std::uint32_t id) const {
    std::vector<std::string> texts;
    for (const ArchivedMeasure& measure : archive_.measures(id))
      texts.push_back(measure.name + " " + short_quantity(measure.value, measure.unit));
    for (const ArchivedNote& note : archive_.notes(id))
      texts.push_back(note.name + " " + short_quantity(note.value, note.unit));
    if (!texts.empty()) std::cout << "    " << joined(texts, ", ") << '\n';
  }

  /// Prints each objective in each life, if there were several.
  void print_lives(const std::vector<std::vector<double>>& lives) const {
    if (lives.size() < 2) return;
    for (std::size_t i = 0; i < objectives_.size(); ++i) {
      std::vector<std::string> values;
      for (const std::vector<double>& life : lives) values.push_back(short_number(life[i]));
      std::cout << "    " << objectives_[i].name << " by life: " << joined(values, ", ") << '\n';
    }
  }

  /// Prints the mean of an objective over the lives and repeats of each scenario.
  static void print_tests(const std::vector<ArchivedTest>& tests, const Objective& objective) {
    std::vector<std::string> scenarios;
    std::map<std::string, std::vector<double>> values;
    for (const ArchivedTest& test : tests) {
      if (test.objective != objective.name) continue;
      if (!values.contains(test.scenario)) scenarios.push_back(test.scenario);
      values[test.scenario].push_back(test.value);
    }
    if (scenarios.empty()) return;
    std::cout << "    " << objective.name << " by scenario:";
    for (std::size_t i = 0; i < scenarios.size(); ++i) {
      const std::vector<double>& repeats = values[scenarios[i]];
      const double mean = std::accumulate(repeats.begin(), repeats.end(), 0.0) / static_cast<double>(repeats.size());
      std::cout << (i > 0 ? ", " : " ") << scenarios[i] << ' ' << short_number(mean);
    }
    std::cout << '\n';
  }

  /// Returns a text such as: 17 (add-node: +1 node, +2 link) < 4 (random).
  std::string line_text(const std::vector<ArchivedIndividual>& line) const {
    std::string text;
    for (std::size_t i = 0; i < line.size(); ++i) {
      text += (i > 0 ? " < " : "") + std::to_string(line[i].id) + " (" + line[i].made_by;
      if (const auto& from = line[i].migrated)
        text += " of " + std::to_string(from->individual) +
                (from->island == 0 ? " in the other run" : " from island " + std::to_string(from->island));
      if (i + 1 < line.size())
        text += changes_text(block_changes(line[i + 1].genome, line[i].genome, layout_), layout_);
      text += ")";
    }
    return text;
  }

  static std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }
  static std::string number(const std::optional<double>& value) { return value ? short_number(*value) : "-"; }

  const Archive& archive_;
  std::vector<Objective> objectives_;
  Layout layout_;
  std::vector<Summary> generations_;
  NicheMap map_;
  std::uint32_t last_generation_;
  std::vector<Column> columns_;  ///< of the objectives
};

/// Prints a line for each island of a run.
void print_islands(const fs::path& run) {
  fmt::print(std::cout, "{:>6} {:>11} {:>12} {:>10} {:>10} {:>11} {:>12}\n", "island", "generations", "evaluations",
             "best", "individual", "immigrants", "of them live");
  for (const fs::path& folder : island_folders(run)) {
    const Archive archive = Archive::read(folder);
    const std::vector<Summary> generations = archive.generations();
    const std::vector<std::uint32_t> best = archive.best(1);
    std::int64_t immigrants = 0, living = 0;
    for (const Immigrant& one : archive.immigrants()) {
      ++immigrants;
      living += !one.died;
    }
    fmt::print(std::cout, "{:>6} {:>11} {:>12} {:>10} {:>10} {:>11} {:>12}\n", archive.island(), generations.size(),
               generations.empty() ? 0 : generations.back().evaluations,
               best.empty() ? "-" : short_number(archive.known_individual(best.front()).result.objectives.front()),
               best.empty() ? "-" : std::to_string(best.front()), immigrants, living);
  }
  remarks() << "to see more of an island: " << shell_command({"show", island_folder(run, 1).string()}) << '\n';
}

/// Shows a run with islands.
int show_islands(const fs::path& run, const Given& given) {
  if (given.contains("individual"))
    throw UsageError(option_text("individual", std::to_string(given["individual"].as<std::int64_t>())) +
                     ": each island has its own individuals; give the folder of one, such as " +
                     island_folder(run, 1).string());
  if (!given.contains("json")) {
    print_islands(run);
    return 0;
  }
  nlohmann::ordered_json islands = nlohmann::ordered_json::array(), best_island = nullptr;
  std::vector<Archive> archives;
  for (const fs::path& folder : island_folders(run)) {
    const Archive& archive = archives.emplace_back(Archive::read(folder));
    islands.push_back(run_json(archive, recorded_settings(archive)));
  }
  if (const auto best = best_of_islands(archives, 1); !best.empty())
    best_island = archives[best.front().island].island();
  std::cout << json_text({{"best_island", best_island}, {"islands", std::move(islands)}}) << '\n';
  return 0;
}

/// Shows a run, and what `signal` has measured of it, if it has.
void show_run(const Archive& archive) {
  Report(archive).print();
  const std::vector<SignalNumber> signal = archive.signal();
  if (signal.empty()) return;
  std::cout << '\n';
  for (const std::string& sentence : sentences_on(signal, recorded_settings(archive), archive.objectives().front()))
    std::cout << wrapped(sentence) << '\n';
}

int show(const Given& given) {
  const fs::path folder = given["DIR"].as<std::string>();
  if (has_islands(folder)) return show_islands(folder, given);
  const Archive archive = Archive::read(folder);
  const bool is_one = given.contains("individual");
  if (is_one && given.contains("json"))
    std::cout << json_text(individual_json(archive, chosen_individual(archive, given))) << '\n';
  else if (is_one)
    Report(archive).print_individual(chosen_individual(archive, given).id);
  else if (given.contains("json"))
    std::cout << json_text(run_json(archive, recorded_settings(archive))) << '\n';
  else
    show_run(archive);
  return 0;
}

}  // namespace

Command show_command() {
  Options options;
  options.add_options()("individual", value<std::int64_t>("ID"), "show this individual alone");
  options.add_options()("json", "print JSON, with every generation");
  return {
      .name = "show",
      .arguments = {{"DIR"}},
      .summary = "Show the progress and the best robots of a run",
      .text =
          {"It prints the best and the median of each objective by generation, the coverage and the QD score (the "
           "sum of the elites' first objectives, of which negative ones count as 0) of the map of niches if the "
           "experiment has descriptors, why individuals have no fitness, and the best individuals "
           "with their scores, their ancestors, and the blocks of genes that came and went from one to the next. The "
           "run may still be in progress. With --individual, it prints one individual: its scores, what the selection "
           "operator has noted about it, and its ancestors. Of a run with islands, it prints a line for each; to see "
           "more of one, give its folder."},
      .examples = {"show runs/quickstart-1", "show runs/quickstart-1 --individual 295",
                   "show runs/quickstart-1 --json"},
      .options = options,
      .function = show};
}

}  // namespace evodevo
