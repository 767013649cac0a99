// The functions of Archive that read scores and lives apart from the individuals that have them.
#include <limits>

#include "archive/archive.hpp"
#include "archive/database.hpp"
#include "base/text.hpp"

namespace evodevo {
namespace {

/// Reads the role of a score that is not an objective.
std::string role_in(const Statement& row, int column) {
  std::string role = row.text(column);
  for (const Role known : {Role::descriptor, Role::constraint, Role::measure})
    if (role == name(known)) return role;
  row.refuse(column, "\"descriptor\", \"constraint\" or \"measure\"");
}

}  // namespace

std::vector<ArchivedMeasure> Archive::measures(std::uint32_t id) const {
  Statement row(*run_, "measured",
                "SELECT name, unit, role, value FROM measured JOIN measures ON position = measure "
                "WHERE individual = ? ORDER BY position");
  row.bind(id);
  std::vector<ArchivedMeasure> measures;
  while (row.step()) measures.push_back({{row.line(0), row.line(1), role_in(row, 2)}, row.number(3)});
  return measures;
}

std::vector<MeasureKind> Archive::measures() const {
  Statement row(*run_, "measures", "SELECT name, unit, role FROM measures ORDER BY position");
  std::vector<MeasureKind> measures;
  while (row.step()) measures.push_back({row.line(0), row.line(1), role_in(row, 2)});
  return measures;
}

std::vector<Objective> Archive::descriptors() const {
  Statement row(*run_, "measures",
                "SELECT name, unit, low, high, bins FROM measures WHERE role = 'descriptor' ORDER BY position");
  std::vector<Objective> descriptors;
  while (row.step()) {
    Objective& descriptor = descriptors.emplace_back(Objective{row.line(0), row.line(1)});
    descriptor.role = Role::descriptor;
    descriptor.low = row.number(2);
    descriptor.high = row.number(3);
    if (!(descriptor.low < descriptor.high)) row.refuse(3, "more than measures.low, " + to_text(descriptor.low));
    descriptor.bins = static_cast<std::uint32_t>(row.integer(4, 1, Objective::most_bins));
  }
  return descriptors;
}

std::vector<Described> Archive::described(std::size_t count) const {
  Statement row(
      *run_, "measured",
      "SELECT id, born, scores.value, measured.value, position FROM individuals JOIN scores ON scores.individual = id "
      "LEFT JOIN measures ON role = 'descriptor' "
      "LEFT JOIN measured ON measured.individual = id AND measured.measure = position "
      "WHERE objective = 0 AND status = 'ok' ORDER BY id, position");
  std::vector<Described> described;
  while (row.step()) {
    const bool has_descriptor = !row.is_null(4);  // of the experiment
    if (has_descriptor && row.is_null(3))
      refuse("individual " + std::to_string(row.index(0)) + ", which is ok, lacks a descriptor");
    if (described.empty() || described.back().id != row.index(0))
      described.push_back({row.index(0), row.index(1), row.number(2), {}});
    if (has_descriptor && described.back().descriptors.size() < count)
      described.back().descriptors.push_back(row.number(3));
  }
  return described;
}

std::vector<ArchivedTest> Archive::tests(std::uint32_t id) const {
  Statement row(
      *run_, "tests",
      "SELECT life, scenarios.name, repeat, objectives.name, value FROM tests JOIN scenarios USING (scenario) "
      "JOIN objectives ON position = objective WHERE individual = ? "
      "ORDER BY life, scenario, repeat, objective");
  row.bind(id);
  std::vector<ArchivedTest> tests;
  while (row.step())
    tests.push_back({row.index(0), row.line(1), row.integer(2, 0, std::numeric_limits<std::int64_t>::max()),
                     row.line(3), row.number(4)});
  return tests;
}

std::vector<LifeRecord> Archive::lives(std::uint32_t id) const try {
  Statement row(*run_, "lives", "SELECT life, record FROM lives WHERE individual = ? ORDER BY life");
  row.bind(id);
  std::vector<LifeRecord> lives;
  while (row.step()) {
    row.integer(0, std::ssize(lives) + 1, std::ssize(lives) + 1);
    lives.emplace_back(std::string(row.bytes(1)));
  }
  return lives;
} catch (const std::invalid_argument& error) {
  refuse("individual " + std::to_string(id) + ": " + error.what());
}

std::vector<std::uint32_t> Archive::best(std::size_t count, std::size_t objective) const {
  const bool maximise = objectives().at(objective).maximise;
  std::vector<std::uint32_t> ids;
  Statement row(*run_, "scores",
                std::string("SELECT individual FROM scores WHERE objective = ? ORDER BY value ") +
                    (maximise ? "DESC" : "ASC") + ", individual LIMIT ?");
  row.bind(static_cast<std::int64_t>(objective), static_cast<std::int64_t>(count));
  while (row.step()) ids.push_back(row.index(0));
  return ids;
}

std::vector<Membership> Archive::memberships(std::size_t objective) const {
  Statement row(*run_, "individuals",
                "SELECT born, died, value FROM individuals JOIN scores ON individual = id "
                "WHERE objective = ? AND (died IS NULL OR died > born) ORDER BY born, id");
  row.bind(static_cast<std::int64_t>(objective));
  std::vector<Membership> memberships;
  while (row.step()) {
    Membership& one = memberships.emplace_back(Membership{row.index(0), {}, row.number(2)});
    if (!row.is_null(1)) one.died = row.index(1);
  }
  return memberships;
}

}  // namespace evodevo
