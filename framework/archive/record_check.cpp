#include "archive/record_check.hpp"

#include <algorithm>
#include <optional>
#include <sstream>

#include "archive/progress.hpp"
#include "base/genome_sections.hpp"
#include "base/text.hpp"

namespace evodevo {
namespace {

std::string title(const Objective& objective) {
  return (objective.maximise ? "more " : "less ") + objective.name + " in " + objective.unit;
}

/// Returns what is wrong with a change, or an empty text if nothing is. `before` is the cycle of the previous change,
/// or 0 if there is none.
std::string fault_of(const Change& change, std::uint32_t before, const Experiment& experiment) {
  const auto cycles = static_cast<std::uint32_t>(experiment.development.cycles);
  if (change.cycle < std::max(before, 1u) || change.cycle > cycles)
    return "cycle " + std::to_string(change.cycle) + ", expected " + std::to_string(std::max(before, 1u)) + " to " +
           std::to_string(cycles);
  if (change.op && *change.op >= experiment.devo.size())
    return "operator " + std::to_string(*change.op) + " of " + std::to_string(experiment.devo.size());
  if (!change.op && has_causes(change.edits)) return "causes of edits, but no operator that made the edits";
  return "";
}

/// Checks that an individual of the population has all scores that selection operators see.
void check_scores(const Archive& archive, const Experiment& experiment, const Individual& individual) {
  const Result& result = individual.result;
  const auto check = [&](std::size_t count, std::size_t expected, const char* what) {
    if (count != expected && !(result.status != Status::ok && count == 0))
      archive.refuse("individual " + std::to_string(individual.id) + " has " + std::to_string(count) + " " + what +
                     ", expected " + std::to_string(expected));
  };
  const auto tested = std::count_if(experiment.cases.begin(), experiment.cases.end(),
                                    [](const Case& one) { return !one.scenario.empty(); });
  check(result.measures.size(), experiment.measures.size(), "scores that are not objectives");
  check(result.tests.size(), static_cast<std::size_t>(tested) * individual.lives, "scores in scenarios");
  for (const TestScore& test : result.tests)
    if (test.life < 1 || test.life > individual.lives)
      archive.refuse("individual " + std::to_string(individual.id) + " has a score in life " +
                     std::to_string(test.life) + " of " + std::to_string(individual.lives));
}

/// Checks that the recorded titles of notes are those of the experiment's selection operator.
void check_notes(const Archive& archive, const Experiment& experiment) {
  const auto titles = [](const std::vector<NoteTitle>& notes) {
    std::vector<std::string> texts;
    for (const NoteTitle& note : notes)
      texts.push_back(note.name + (note.is_label ? " as a label" : " in " + note.unit));
    return joined(texts);
  };
  const std::string recorded = titles(archive.note_titles()), now = titles(experiment.note_titles());
  if (recorded != now)
    archive.refuse("its selection operator notes " + (recorded.empty() ? "nothing" : recorded) +
                   ", but that of the experiment notes " + (now.empty() ? "nothing" : now) +
                   "; use the operator that made it");
}

/// Checks that only operators that the experiment has remember something.
void check_memory(const Archive& archive, const Experiment& experiment) {
  if (!archive.memory().parents.empty() && !experiment.parent_selection)
    archive.refuse("the operator in [selection.parents] remembers something, but the experiment has none");
}

/// Returns the lines of an experiment, each with its table, without those that say where the experiment is simulated.
/// Those of [experiment] come first, because defaults of other tables follow from them.
std::vector<std::string> lines_that_matter(const Experiment& experiment) {
  std::vector<std::string> lines;
  std::istringstream text(experiment.resolved);
  std::string table;
  for (std::string line; std::getline(text, line);) {
    line.erase(0, line.find_first_not_of(' '));
    if (line.starts_with("[")) table = line;
    const bool is_of_machine =
        table == "[simulation]" && (line.starts_with("device = ") || line.starts_with("threads = "));
    if (!line.empty() && line != table && !is_of_machine) lines.push_back(table + " " + line);
  }
  std::ranges::stable_partition(lines, [](const std::string& line) { return line.starts_with("[experiment]"); });
  return lines;
}

/// Returns the name of the first file whose contents differ, or that only one of the experiments has.
std::optional<std::string> first_other_file(const FileContents& one, const FileContents& other) {
  for (const auto* files : {&one, &other})
    for (const auto& [name, content] : *files)
      if (!one.contains(name) || !other.contains(name) || one.at(name) != other.at(name)) return name;
  return std::nullopt;
}

}  // namespace

void check_same_experiment(const Archive& archive, const Experiment& recorded, const Experiment& named) {
  const auto refuse = [&](const std::string& what) {
    throw ArchiveError(archive.folder().string() + ": is a run of another experiment: " + printable(what) +
                       "; give another folder with --out, or continue that run with `" +
                       shell_command({"resume", archive.folder().string()}) + "`");
  };
  if (recorded.name != named.name) refuse("it is called " + recorded.name + ", not " + named.name);
  const std::vector<std::string> there = lines_that_matter(recorded), here = lines_that_matter(named);
  const auto [one, other] = std::mismatch(there.begin(), there.end(), here.begin(), here.end());
  const auto shown = [](auto line, const auto& lines) { return line == lines.end() ? "nothing more" : *line; };
  if (one != there.end() || other != here.end())
    refuse("its record has " + shown(one, there) + ", but the given experiment has " + shown(other, here));
  if (const auto file = first_other_file(recorded.files, named.files)) refuse("the file " + *file + " has changed");
}

void check_objectives(const Archive& archive, const Experiment& experiment) {
  const std::vector<Objective> recorded = archive.objectives();
  const std::vector<Objective>& now = experiment.objectives;
  for (std::size_t i = 0; i < std::max(recorded.size(), now.size()); ++i) {
    const std::string then_title = i < recorded.size() ? title(recorded[i]) : "none",
                      now_title = i < now.size() ? title(now[i]) : "none";
    if (then_title != now_title)
      archive.refuse("objective " + std::to_string(i) + " is " + then_title +
                     ", but the experiment's fitness operators measure " + now_title);
  }
}

void check_genes(const Archive& archive, const Experiment& experiment, const Individual& individual) {
  check_layout(archive, experiment);
  if (const std::string fault = genome_fault(individual.genome, experiment.layout); !fault.empty())
    archive.refuse("individual " + std::to_string(individual.id) + " has " + fault);
}

void check_layout(const Archive& archive, const Experiment& experiment) {
  if (archive.layout() != experiment.layout)
    archive.refuse(
        "its genomes have another layout than those of the experiment's operators; use the operators that made it");
}

void check_resumable(const Archive& archive, const Experiment& experiment) {
  check_layout(archive, experiment);
  const std::size_t generations = archive.generations().size();
  const std::vector<Individual> population = archive.population();
  const auto least = static_cast<std::size_t>(generations > 0 ? 1 : 0),
             most = generations > 0 ? static_cast<std::size_t>(experiment.population) : 0;
  if (population.size() < least || population.size() > most)
    archive.refuse(std::to_string(population.size()) + " individuals live after " + std::to_string(generations) +
                   " generations, expected " + std::to_string(least) + " to " + std::to_string(most));
  for (const Individual& individual : population) {
    check_genes(archive, experiment, individual);
    check_scores(archive, experiment, individual);
    Newborn newborn = newborn_of(individual);
    newborn.records = archive.lives(individual.id);
    check_lives(archive, experiment, newborn);
  }
  check_notes(archive, experiment);
  check_memory(archive, experiment);
  archive.provenances();
  recorded_time_spent(archive);
}

void check_lives(const Archive& archive, const Experiment& experiment, const Newborn& newborn) {
  if (newborn.records.size() > newborn.lives)
    archive.refuse("it has records of " + std::to_string(newborn.records.size()) + " lives of individual " +
                   std::to_string(newborn.id) + ", which has had " + std::to_string(newborn.lives));
  for (const LifeRecord& record : newborn.records) {
    std::uint32_t before = 0;
    for (const Change& change : record.changes()) {
      if (const std::string fault = fault_of(change, before, experiment); !fault.empty())
        archive.refuse("the record of a life of individual " + std::to_string(newborn.id) + " names " + fault);
      before = change.cycle;
    }
  }
}

}  // namespace evodevo
