#include "archive/remembered.hpp"

#include <limits>
#include <map>

#include "archive/archive.hpp"

namespace evodevo {

void write_remembered(const RunDatabase& run, const Remembered& remembered, std::uint32_t generation) {
  Statement insert(run, "notes",
                   "INSERT INTO notes SELECT ?1, ?2, ?3, ?4 WHERE ?4 IS NOT (SELECT value FROM notes "
                   "WHERE individual = ?1 AND note = ?2 ORDER BY generation DESC LIMIT 1)");
  for (const NoteOf& note : remembered.notes) insert.execute(note.individual, note.title, generation, note.value);
  Statement(run, "memory", "DELETE FROM memory").execute();
  if (remembered.memory.empty()) return;
  const std::string_view bytes(reinterpret_cast<const char*>(remembered.memory.data()), remembered.memory.size());
  Statement(run, "memory", "INSERT INTO memory VALUES(?, ?)").execute(generation, bytes);
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

std::vector<std::byte> Archive::memory() const {
  Statement row(*run_, "memory",
                "SELECT generation, bytes, (SELECT max(generation) FROM generations) AS last FROM memory");
  if (!row.step()) return {};
  if (row.is_null(2)) refuse("the selection operator remembers something, but there are no generations");
  row.integer(0, row.index(2), row.index(2));
  const auto bytes = std::as_bytes(std::span(row.bytes(1)));
  std::vector<std::byte> memory(bytes.begin(), bytes.end());
  if (row.step()) refuse("the table memory has more than one row");
  return memory;
}

}  // namespace evodevo
