#include "evolution/selection_checks.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "base/genome_sections.hpp"
#include "base/text.hpp"

namespace evodevo {
namespace {

constexpr std::size_t most_memory = std::size_t{128} << 20;  ///< bytes; half of the limit of a row of the archive

/// Throws unless the table has a row that an operator has chosen as a parent.
void check_parent(std::uint32_t row, const SelectionContext& context) {
  if (row >= context.rows.size())
    throw std::runtime_error("chose row " + std::to_string(row) + " as a parent, but the table has " +
                             std::to_string(context.rows.size()) + " rows, numbered from 0");
}

/// Checks the notes that an operator makes in one call.
class NoteCheck {
 public:
  /// Notes are about rows or children; `what` says which, and there are `count` of them.
  NoteCheck(const std::vector<NoteTitle>& titles, const char* what, std::size_t count)
      : titles_(titles), what_(what), count_(count) {}

  void operator()(std::uint32_t about, std::uint32_t title, double value) {
    const std::string whom = " about " + std::string(what_) + " " + std::to_string(about);
    if (about >= count_ || title >= titles_.size())
      throw std::runtime_error("noted number " + std::to_string(title) + whom + ", but notes() has " +
                               std::to_string(titles_.size()) + " numbers and there are " + std::to_string(count_) +
                               " " + what_ + "s, both counted from 0");
    const std::string& name = titles_[title].name;
    if (!std::isfinite(value))
      throw std::runtime_error("noted " + name + " = " + to_text(value) + whom +
                               ", expected a finite number for each note of notes()");
    if (!noted_.emplace(about, title).second)
      throw std::runtime_error("noted " + name + " twice" + whom + ", expected one note for each " + what_ +
                               " and number");
  }

 private:
  const std::vector<NoteTitle>& titles_;
  const char* what_;
  std::size_t count_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> noted_;
};

}  // namespace

void check_memory(const SelectionMemory& memory, const std::vector<std::string>& declared) {
  if (memory.empty()) return;
  std::size_t size = 0;
  for (const auto& [name, numbers] : memory.lists) {
    size += numbers.size() * sizeof(double);
    if (std::find(declared.begin(), declared.end(), name) == declared.end())
      throw std::runtime_error("remembers a list \"" + printable(name) +
                               "\" that memory() does not declare; add its name there");
    const auto wrong = std::find_if_not(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
    if (wrong != numbers.end())
      throw std::runtime_error("remembers " + to_text(*wrong) + " as number " +
                               std::to_string(wrong - numbers.begin()) + " of the list \"" + name +
                               "\", counted from 0; expected finite numbers");
  }
  for (const std::string& name : declared)
    if (!memory.lists.contains(name))
      throw std::runtime_error("remembers no list \"" + name +
                               "\", which memory() declares; write it, even if it is "
                               "empty, or do not declare it");
  if (size > most_memory)
    throw std::runtime_error("remembers " + std::to_string(size) + " bytes, expected at most " +
                             std::to_string(most_memory));
}

void check_couples(std::span<const Couple> couples, const SelectionContext& context, std::uint32_t count) {
  if (couples.size() != count)
    throw std::runtime_error("chose " + std::to_string(couples.size()) + " pairs of parents, expected " +
                             std::to_string(count));
  for (const auto& [parent, mate] : couples) check_parent(std::max(parent, mate), context);
}

void check_survival(const Survival& survival, const Declared& declared, const SelectionContext& context,
                    std::uint32_t population) {
  std::vector<std::uint32_t> rows = survival.rows;
  std::sort(rows.begin(), rows.end());
  const std::string expected = "; expected 1 to " + std::to_string(population) + " different rows of " +
                               std::to_string(context.rows.size()) + ", numbered from 0";
  if (rows.empty() || rows.size() > population)
    throw std::runtime_error("chose " + std::to_string(rows.size()) + " survivors" + expected);
  if (rows.back() >= context.rows.size())
    throw std::runtime_error("chose row " + std::to_string(rows.back()) + " to survive" + expected);
  if (const auto twin = std::adjacent_find(rows.begin(), rows.end()); twin != rows.end())
    throw std::runtime_error("chose row " + std::to_string(*twin) + " twice to survive" + expected);
  NoteCheck check(declared.notes, "row", context.rows.size());
  for (const Note& note : survival.notes) check(note.row, note.title, note.value);
  if (survival.memory) check_memory(*survival.memory, declared.memory);
}

void check_offspring(const Offspring& offspring, const Declared& declared, const SelectionContext& context,
                     std::uint32_t count) {
  const std::vector<Child>& children = offspring.children;
  if (children.size() != count)
    throw std::runtime_error("made " + std::to_string(children.size()) + " children, expected " +
                             std::to_string(count));
  NoteCheck check(declared.notes, "child", children.size());
  for (std::uint32_t i = 0; i < children.size(); ++i) {
    const Child& child = children[i];
    check_genome(child.genome, context.layout);
    if (child.parents.size() > 2)
      throw std::runtime_error("made a child of " + std::to_string(child.parents.size()) + " parents, expected 0 to 2");
    for (const std::uint32_t row : child.parents) check_parent(row, context);
    for (const ChildNote& note : child.notes) check(i, note.title, note.value);
  }
  if (offspring.memory) check_memory(*offspring.memory, declared.memory);
}

void check_genome(const Genome& genome, const Layout& layout) {
  if (const std::string fault = genome_fault(genome, layout); !fault.empty())
    throw std::runtime_error("made a genome with " + fault);
}

}  // namespace evodevo
