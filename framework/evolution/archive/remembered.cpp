#include "evolution/archive/remembered.hpp"

#include "base/text.hpp"
#include "evolution/archive/archive.hpp"

namespace evodevo {
namespace {

std::string text_in(const Statement& row, int column) { return printable(row.text(column)); }

}  // namespace

void write_remembered(const RunDatabase& run, const Remembered& remembered, std::uint32_t generation) {
  Statement insert(run, "notes", "INSERT OR REPLACE INTO notes VALUES(?, ?, ?)");
  for (const NoteOf& note : remembered.notes) insert.execute(note.individual, note.title, note.value);
  Statement(run, "memory", "DELETE FROM memory").execute();
  if (remembered.memory.empty()) return;
  const std::string_view bytes(reinterpret_cast<const char*>(remembered.memory.data()), remembered.memory.size());
  Statement(run, "memory", "INSERT INTO memory VALUES(?, ?)").execute(generation, bytes);
}

std::vector<NoteTitle> Archive::note_titles() const {
  std::vector<NoteTitle> titles;
  Statement row(*run_, "note_titles", "SELECT position, name, unit FROM note_titles ORDER BY position");
  for (std::uint32_t position = 0; row.step(); ++position) {
    row.integer(0, position, position);
    titles.push_back({text_in(row, 1), text_in(row, 2)});
  }
  return titles;
}

std::vector<ArchivedNote> Archive::notes(std::uint32_t id) const {
  Statement row(*run_, "notes",
                "SELECT name, unit, value FROM notes JOIN note_titles ON position = note WHERE individual = ? "
                "ORDER BY position");
  row.bind(id);
  std::vector<ArchivedNote> notes;
  while (row.step()) notes.push_back({text_in(row, 0), text_in(row, 1), row.number(2)});
  return notes;
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
