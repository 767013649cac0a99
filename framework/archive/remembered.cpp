#include "archive/remembered.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "archive/archive.hpp"

namespace evodevo {
namespace {

static_assert(sizeof(double) == 8 && std::endian::native == std::endian::little);

/// Whose memory a row of the table has.
struct MemoryRole {
  const char* name;
  SelectionMemory Memories::*memory;
};
constexpr std::array memory_roles = {MemoryRole{"survivors", &Memories::survivors},
                                     MemoryRole{"parents", &Memories::parents}};

}  // namespace

void write_remembered(const RunDatabase& run, const Remembered& remembered, std::uint32_t generation) {
  Statement insert(run, "notes",
                   "INSERT INTO notes SELECT ?1, ?2, ?3, ?4 WHERE ?4 IS NOT (SELECT value FROM notes "
                   "WHERE individual = ?1 AND note = ?2 ORDER BY generation DESC LIMIT 1)");
  for (const NoteOf& note : remembered.notes) insert.execute(note.individual, note.title, generation, note.value);
  Statement(run, "memory", "DELETE FROM memory").execute();
  Statement insert_list(run, "memory", "INSERT INTO memory VALUES(?, ?, ?, ?, ?)");
  for (const auto& [role, of_role] : memory_roles)
    for (const auto& [name, numbers] : (remembered.memory.*of_role).lists) {
      const std::string_view bytes(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double));
      insert_list.execute(role, name, generation, (remembered.memory.*of_role).version, bytes);
    }
}

std::vector<NoteTitle> Archive::note_titles() const {
  std::vector<NoteTitle> titles;
  Statement row(*run_, "note_titles", "SELECT position, name, unit, is_label FROM note_titles ORDER BY position");
  for (std::uint32_t position = 0; row.step(); ++position) {
    row.integer(0, position, position);
    titles.push_back({row.line(1), row.line(2), row.integer(3, 0, 1) == 1});
  }
  return titles;
}

std::vector<ArchivedNote> Archive::notes(std::uint32_t id) const {
  Statement row(
      *run_, "notes",
      "SELECT name, unit, value, max(generation) FROM notes JOIN note_titles ON position = note "
      "WHERE individual = ? GROUP BY note ORDER BY note");  // SQLite takes `value` from the row of the maximum
  row.bind(id);
  std::vector<ArchivedNote> notes;
  while (row.step()) notes.push_back({row.line(0), row.line(1), row.number(2)});
  return notes;
}

std::vector<NoteHistory> Archive::note_histories() const {
  std::vector<NoteHistory> histories;
  for (NoteTitle& title : note_titles()) histories.push_back({std::move(title), {}});
  if (histories.empty()) return histories;
  const std::vector<Summary> summaries = generations();
  struct Noted {
    double value;
    std::uint32_t until;  // generation whose selection dropped the individual
  };
  std::vector<std::map<std::uint32_t, Noted>> living(histories.size());  // by individual
  Statement row(*run_, "notes",
                "SELECT generation, note, individual, value, died FROM notes JOIN individuals ON id = individual "
                "ORDER BY generation");
  bool is_left = row.step();
  for (const Summary& summary : summaries) {
    for (; is_left && row.index(0) <= summary.generation; is_left = row.step())
      living[row.index(1, static_cast<std::uint32_t>(histories.size() - 1))].insert_or_assign(
          row.index(2),
          Noted{row.number(3), row.is_null(4) ? std::numeric_limits<std::uint32_t>::max() : row.index(4)});
    for (std::size_t i = 0; i < histories.size(); ++i) {
      std::erase_if(living[i], [&](const auto& one) { return one.second.until <= summary.generation; });
      std::vector<double>& values = histories[i].living.emplace_back();
      for (const auto& [individual, noted] : living[i]) values.push_back(noted.value);
    }
  }
  if (is_left) row.refuse(0, "a generation of the run");
  return histories;
}

Memories Archive::memory() const {
  Memories memories;
  Statement row(
      *run_, "memory",
      "SELECT role, name, generation, version, numbers, (SELECT max(generation) FROM generations) FROM memory");
  while (row.step()) {
    if (row.is_null(5)) refuse("a selection operator remembers something, but there are no generations");
    const std::string role = row.line(0);
    const auto found = std::ranges::find(memory_roles, role, &MemoryRole::name);
    if (found == memory_roles.end()) row.refuse(0, "\"survivors\" or \"parents\"");
    SelectionMemory& memory = memories.*found->memory;
    row.integer(2, row.index(5), row.index(5));
    const std::uint32_t version = memory.empty() ? row.index(3) : memory.version;
    row.integer(3, version, version);
    memory.version = version;
    const std::string_view bytes = row.bytes(4);
    std::vector<double> numbers(bytes.size() / sizeof(double));
    if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(double));
    if (bytes.size() % sizeof(double) != 0 ||
        !std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); }))
      row.refuse(4, "finite numbers of 8 bytes each");
    memory.lists[row.text(1)] = std::move(numbers);
  }
  return memories;
}

}  // namespace evodevo
