// The functions of Archive that read. They check every value.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "archive/archive.hpp"
#include "archive/database.hpp"
#include "archive/genes.hpp"
#include "base/text.hpp"

namespace evodevo {
namespace {

constexpr std::int64_t no_limit = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t most_ids = std::int64_t{1} << 32;  ///< largest number of evaluations, each of which uses one id

constexpr std::array statuses_known{Status::ok,       Status::invalid, Status::diverged,
                                    Status::artefact, Status::passive, Status::lucky};

Status status_in(const Statement& row, int column) {
  const std::string text = row.text(column);
  for (const Status status : statuses_known)
    if (text == name(status)) return status;
  row.refuse(column, "\"ok\", \"invalid\", \"diverged\", \"artefact\", \"passive\" or \"lucky\"");
}

std::string line_or_empty(const Statement& row, int column) { return row.is_null(column) ? "" : row.line(column); }

/// Returns the number of seconds in a text, or nullopt if the text is not a finite number of at least 0.
std::optional<double> seconds_in(const std::string& text) {
  double seconds = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole && seconds >= 0 && std::isfinite(seconds) ? std::optional(seconds) : std::nullopt;
}

/// Returns the reason of a failure without the number of the life that failed, as in "life 2: ".
std::string without_life(const std::string& reason) {
  const std::size_t number = std::string_view("life ").size(), end = reason.find_first_not_of("0123456789", number);
  const bool names_life = reason.starts_with("life ") && end != number && reason.compare(end, 2, ": ") == 0;
  return names_life ? reason.substr(end + 2) : reason;
}

std::int64_t count_of(const RunDatabase& run, const std::string& table) {
  Statement row(run, table, "SELECT count(*) FROM " + table);
  row.step();
  return row.integer(0, 0, no_limit);
}

constexpr const char* individual_columns =
    "SELECT id, born, origin, parent, mate, made_by, genes, status, reason, ended_at, spring_evaluations, died, "
    "blocks, provenance, island, source, lives, measured FROM individuals LEFT JOIN immigrants ON individual = id ";

/// Reads individuals and checks them against the run's generations and objectives.
class Individuals {
 public:
  Individuals(const RunDatabase& run, const Layout& layout, const std::string& which)
      : run_(run),
        layout_(layout),
        objectives_(count_of(run, "objectives")),
        row_(run, "individuals", individual_columns + which),
        measures_(count_of(run, "measures")),
        provenances_(count_of(run, "provenances")),
        scenarios_(count_of(run, "scenarios")),
        scores_(run, "scores", "SELECT objective, value FROM scores WHERE individual = ? ORDER BY objective"),
        measured_(run, "measured", "SELECT measure, value FROM measured WHERE individual = ? ORDER BY measure"),
        lives_(run, "life_scores",
               "SELECT life, objective, value FROM life_scores WHERE individual = ? ORDER BY life, objective"),
        tests_(run, "tests",
               "SELECT life, scenario, repeat, objective, value FROM tests WHERE individual = ? "
               "ORDER BY life, scenario, repeat, objective") {
    if (provenances_ == 0) run.refuse("the table provenances is empty");
    Statement last(run, "generations",
                   "SELECT generation, evaluations FROM generations ORDER BY generation DESC LIMIT 1");
    if (!last.step()) return;
    last_generation_ = last.index(0);
    check_ids(last.integer(1, 0, most_ids));
  }

  Statement& row() { return row_; }

  std::optional<ArchivedIndividual> next() {
    if (!row_.step()) return std::nullopt;
    if (!last_generation_) run_.refuse("there are individuals, but no generations");
    ArchivedIndividual individual;
    individual.id = row_.index(0);
    individual.born = row_.index(1, *last_generation_);
    individual.origin = row_.index(2, individual.born);
    read_parents(individual);
    individual.made_by = row_.line(5);
    individual.provenance = static_cast<std::uint32_t>(row_.integer(13, 0, provenances_ - 1));
    individual.lives = static_cast<std::uint32_t>(row_.integer(16, 1, most_lives));
    individual.measured = static_cast<std::uint32_t>(row_.integer(17, individual.born, *last_generation_));
    individual.genome = read_genome(row_, 6, 12, layout_);
    read_result(individual.result);
    if (!row_.is_null(14)) individual.migrated = Migrated{row_.integer(14, 0, most_islands), row_.index(15)};
    if (!row_.is_null(11))
      individual.died = static_cast<std::uint32_t>(row_.integer(11, individual.born, *last_generation_));
    read_scores(individual);
    read_measures(individual);
    read_tests(individual);
    return individual;
  }

 private:
  /// Checks that no table has a row for an id that a later individual of the run will get.
  void check_ids(std::int64_t evaluations) {
    for (const char* column : {"individuals.id", "scores.individual", "lives.individual", "verifications.individual",
                               "measured.individual", "life_scores.individual", "tests.individual", "notes.individual",
                               "immigrants.individual", "emigrants.individual"}) {
      const std::string_view name(column);
      const std::string table(name.substr(0, name.find('.'))), key(name.substr(table.size() + 1));
      Statement last(run_, table, "SELECT max(" + key + ") AS " + key + " FROM " + table);
      if (last.step() && !last.is_null(0) && last.index(0) >= evaluations)
        last.refuse(0, "less than the number of evaluations, " + std::to_string(evaluations));
    }
  }

  /// Reads the parents and checks that they were born before the individual, so that ancestry has no cycles.
  void read_parents(ArchivedIndividual& individual) {
    for (const int column : {3, 4}) {
      if (row_.is_null(column)) continue;
      individual.parents.push_back(row_.index(column));
      if (individual.parents.back() >= individual.id) row_.refuse(column, "less than the id of the individual itself");
    }
  }

  void read_result(Result& result) {
    result.status = status_in(row_, 7);
    result.reason = line_or_empty(row_, 8);
    result.ended_at = row_.optional_number(9).value_or(0);
    result.spring_evaluations = static_cast<std::uint64_t>(row_.integer(10, 0, no_limit));
  }

  void read_scores(ArchivedIndividual& individual) {
    std::vector<double>& objectives = individual.result.objectives;
    scores_.bind(individual.id);
    while (scores_.step()) {
      const auto position = static_cast<std::int64_t>(objectives.size());
      scores_.integer(0, position, position);
      objectives.push_back(scores_.number(1));
    }
    const std::int64_t expected = individual.result.status == Status::ok ? objectives_ : 0;
    if (static_cast<std::int64_t>(objectives.size()) != expected)
      run_.refuse("individual " + std::to_string(individual.id) + ", which is " + name(individual.result.status) +
                  ", has " + std::to_string(objectives.size()) + " scores, expected " + std::to_string(expected));
    read_lives(individual);
  }

  void read_lives(ArchivedIndividual& individual) {
    std::vector<std::vector<double>>& lives = individual.result.lives;
    lives_.bind(individual.id);
    while (lives_.step()) {
      if (lives.empty() || std::ssize(lives.back()) == objectives_) lives.emplace_back();
      const std::int64_t life = std::ssize(lives), position = std::ssize(lives.back());
      lives_.integer(0, life, life);
      lives_.integer(1, position, position);
      lives.back().push_back(lives_.number(2));
    }
    const bool is_ok = individual.result.status == Status::ok;
    if (lives.empty() && is_ok && individual.lives == 1) lives.push_back(individual.result.objectives);
    const std::size_t expected = is_ok ? individual.lives : 0;
    if (lives.size() != expected || (!lives.empty() && std::ssize(lives.back()) != objectives_))
      run_.refuse("individual " + std::to_string(individual.id) + ", which is " + name(individual.result.status) +
                  " and has had " + std::to_string(individual.lives) + " lives, has scores of " +
                  std::to_string(lives.size()) + " lives, of which the last may be incomplete; expected " +
                  std::to_string(expected));
  }

  /// Reads the scores that are not objectives. An individual that failed has none, or all if it violates a constraint.
  void read_measures(ArchivedIndividual& individual) {
    std::vector<double>& measures = individual.result.measures;
    measured_.bind(individual.id);
    while (measured_.step()) {
      const auto position = static_cast<std::int64_t>(measures.size());
      measured_.integer(0, position, position);
      measures.push_back(measured_.number(1));
    }
    const auto count = static_cast<std::int64_t>(measures.size());
    const bool may_have_none = individual.result.status != Status::ok;
    if (count != measures_ && !(may_have_none && count == 0))
      run_.refuse("individual " + std::to_string(individual.id) + ", which is " + name(individual.result.status) +
                  ", has " + std::to_string(count) + " measures, expected " + std::to_string(measures_));
  }

  void read_tests(ArchivedIndividual& individual) {
    if (scenarios_ == 0) return;
    tests_.bind(individual.id);
    while (tests_.step())
      individual.result.tests.push_back(
          {tests_.index(0), static_cast<std::size_t>(tests_.integer(1, 0, scenarios_ - 1)),
           tests_.integer(2, 0, no_limit), static_cast<std::size_t>(tests_.integer(3, 0, objectives_ - 1)),
           tests_.number(4)});
  }

  const RunDatabase& run_;
  const Layout& layout_;
  std::int64_t objectives_;
  Statement row_;
  std::int64_t measures_, provenances_, scenarios_;
  Statement scores_, measured_, lives_, tests_;
  std::optional<std::uint32_t> last_generation_;
};

}  // namespace

std::optional<Verification> Archive::verification(std::uint32_t id) const {
  Statement row(*run_, "verifications",
                "SELECT trial, status, reason, value FROM verifications WHERE individual = ? ORDER BY position");
  row.bind(id);
  Verification verification{id, 0, {}};
  while (row.step())
    verification.trials.push_back({row.line(0), status_in(row, 1), line_or_empty(row, 2), row.optional_number(3)});
  if (verification.trials.empty()) return std::nullopt;
  const ArchivedIndividual verified = known_individual(id);
  if (verified.result.objectives.empty())
    refuse("individual " + std::to_string(id) + " is verified, but has no scores");
  verification.fitness = verified.result.objectives.front();
  return verification;
}

std::string Archive::record(const std::string& key) const {
  auto value = find_record(key);
  if (!value) refuse("the table record has no key \"" + key + "\"");
  return std::move(*value);
}

std::optional<std::string> Archive::find_record(const std::string& key) const {
  Statement row(*run_, "record", "SELECT value FROM record WHERE key = ?");
  row.bind(key);
  if (!row.step()) return std::nullopt;
  return row.text(0);
}

std::optional<double> Archive::find_seconds(const std::string& key) const {
  Statement row(*run_, "record", "SELECT value FROM record WHERE key = ?");
  row.bind(key);
  if (!row.step()) return std::nullopt;
  const auto seconds = seconds_in(row.text(0));
  if (!seconds) row.refuse(0, "a number of seconds for \"" + key + "\"");
  return seconds;
}

std::vector<Provenance> Archive::provenances() const {
  std::vector<Provenance> provenances;
  Statement row(*run_, "provenances",
                "SELECT provenance, device, evodevo, program FROM provenances ORDER BY provenance");
  for (std::uint32_t position = 0; row.step(); ++position) {
    row.integer(0, position, position);
    provenances.push_back({row.line(1), row.line(2), row.line(3), {}});
  }
  if (provenances.empty()) refuse("the table provenances is empty");
  Statement use(*run_, "operators", "SELECT provenance, kind, name, version, file, hash FROM operators ORDER BY rowid");
  while (use.step())
    provenances[use.index(0, static_cast<std::uint32_t>(provenances.size() - 1))].operators.push_back(
        {use.line(1), use.line(2), use.line(3), use.line(4), use.line(5)});
  return provenances;
}

std::vector<std::int64_t> Archive::evaluated_by_provenance() const {
  std::vector<std::int64_t> counts(provenances().size());
  Statement row(*run_, "individuals", "SELECT provenance, count(*) FROM individuals GROUP BY provenance");
  while (row.step()) counts[row.index(0, static_cast<std::uint32_t>(counts.size() - 1))] = row.integer(1, 0, no_limit);
  return counts;
}

std::int64_t Archive::island() const {
  if (!find_record("island")) return 0;
  Statement row(*run_, "record", "SELECT CAST(value AS INTEGER) AS value FROM record WHERE key = 'island'");
  row.step();
  return row.integer(0, 1, most_islands);
}

std::vector<Immigrant> Archive::immigrants() const {
  std::vector<Immigrant> immigrants;
  Statement row(
      *run_, "immigrants",
      "SELECT id, born, died, island, source FROM immigrants JOIN individuals ON id = individual WHERE island > 0 "
      "ORDER BY id");
  while (row.step()) {
    Immigrant& one = immigrants.emplace_back(Immigrant{row.index(0), row.index(1), std::nullopt, {}});
    if (!row.is_null(2)) one.died = row.index(2);
    one.from = {row.integer(3, 1, most_islands), row.index(4)};
  }
  return immigrants;
}

std::map<std::uint32_t, std::vector<std::uint32_t>> Archive::emigrants_to(std::int64_t island,
                                                                          std::uint32_t since) const {
  std::map<std::uint32_t, std::vector<std::uint32_t>> emigrants;
  Statement row(*run_, "emigrants",
                "SELECT generation, individual FROM emigrants WHERE island = ? AND generation >= ? "
                "ORDER BY generation, individual");
  row.bind(island, static_cast<std::int64_t>(since));
  while (row.step()) emigrants[row.index(0)].push_back(row.index(1));
  return emigrants;
}

std::vector<Objective> Archive::objectives() const {
  std::vector<Objective> objectives;
  Statement row(*run_, "objectives", "SELECT position, name, unit, maximise FROM objectives ORDER BY position");
  for (std::uint32_t position = 0; row.step(); ++position) {
    row.integer(0, position, position);
    objectives.push_back({row.line(1), row.line(2), row.integer(3, 0, 1) != 0});
  }
  if (objectives.empty()) refuse("the table objectives is empty");
  return objectives;
}

FileContents Archive::files() const {
  FileContents files;
  Statement row(*run_, "files", "SELECT path, content FROM files");
  while (row.step()) files.emplace(row.text(0), row.bytes(1));
  return files;
}

const Layout& Archive::layout() const {
  if (!layout_) layout_ = read_layout(*run_);
  return *layout_;
}

std::vector<Summary> Archive::generations() const {
  std::vector<Summary> summaries;
  Statement row(*run_, "generations",
                "SELECT generation, evaluations, best, median, diverged, invalid, artefact, lucky, passive, clones, "
                "spring_evaluations, wall_time FROM generations ORDER BY generation");
  while (row.step()) {
    const auto position = static_cast<std::int64_t>(summaries.size());
    Summary& summary = summaries.emplace_back();
    summary.generation = static_cast<std::uint32_t>(row.integer(0, position, position));
    summary.evaluations = row.integer(1, position > 0 ? summaries[summaries.size() - 2].evaluations : 0, most_ids);
    summary.best = row.optional_number(2);
    summary.median = row.optional_number(3);
    summary.diverged = row.integer(4, 0, summary.evaluations);
    summary.invalid = row.integer(5, 0, summary.evaluations);
    summary.artefact = row.integer(6, 0, summary.evaluations);
    summary.lucky = row.integer(7, 0, summary.evaluations);
    summary.passive = row.integer(8, 0, summary.evaluations);
    summary.clones = row.integer(9, 0, summary.evaluations);
    summary.spring_evaluations = static_cast<std::uint64_t>(row.integer(10, 0, no_limit));
    summary.wall_time = row.number(11);
  }
  return summaries;
}

std::map<std::string, std::int64_t> Archive::statuses() const {
  std::map<std::string, std::int64_t> counts;
  for (const Status status : statuses_known) counts[name(status)] = 0;
  Statement row(*run_, "individuals", "SELECT status, count(*) FROM individuals GROUP BY status");
  while (row.step()) counts[name(status_in(row, 0))] = row.integer(1, 0, no_limit);
  return counts;
}

std::vector<Failure> Archive::failures() const {
  std::map<std::pair<std::string, std::string>, Failure> failures;
  Statement row(*run_, "individuals",
                "SELECT status, reason, count(*) FROM individuals WHERE status <> 'ok' "
                "GROUP BY status, reason ORDER BY min(id)");
  while (row.step()) {
    const std::string status = name(status_in(row, 0)), reason = line_or_empty(row, 1);
    const std::string cause = without_life(reason), alike = cause.substr(0, cause.find_first_of("0123456789"));
    Failure& failure = failures.try_emplace({status, alike}, Failure{status, reason}).first->second;
    failure.count += row.integer(2, 0, no_limit);
    failure.varies |= failure.reason != reason;
  }
  std::vector<Failure> sorted;
  for (auto& [key, failure] : failures) sorted.push_back(std::move(failure));
  std::stable_sort(sorted.begin(), sorted.end(), [](const Failure& a, const Failure& b) { return a.count > b.count; });
  return sorted;
}

std::vector<Individual> Archive::population() const {
  std::vector<Individual> population;
  Individuals living(*run_, layout(), "WHERE died IS NULL ORDER BY id");
  while (auto individual = living.next()) population.push_back(std::move(*individual));
  return population;
}

std::optional<ArchivedIndividual> Archive::individual(std::uint32_t id) const {
  Individuals one(*run_, layout(), "WHERE id = ?");
  one.row().bind(id);
  return one.next();
}

ArchivedIndividual Archive::known_individual(std::uint32_t id) const {
  auto known = individual(id);
  if (!known) refuse("it refers to individual " + std::to_string(id) + ", which it does not have");
  return std::move(*known);
}

}  // namespace evodevo
