// Changes in the record of a run. Each is a column, a row and a value of any type.
#include "archive/archive.hpp"

#include "archive/record_check.hpp"
#include "archive/recorded_experiment.hpp"
#include "fuzz/embedded.hpp"
#include "fuzz/input.hpp"
#include "fuzz/small_run.hpp"
#include "fuzz/target.hpp"
#include "report/run_json.hpp"

namespace evodevo {
namespace {

const SmallRun& small_run() {
  static const SmallRun run;
  return run;
}

const std::vector<Column>& all_columns() {
  static const std::vector<Column> columns = [] {
    SQLite::Database record = small_run().renewed();
    return columns_of(record);
  }();
  return columns;
}

/// Binds the value that comes next in an input.
void bind_value(SQLite::Statement& update, Input& input) {
  const std::size_t type = input.below(5);
  if (type == 0) return update.bind(1);  // NULL
  if (type == 1) return update.bind(1, input.number<std::int64_t>());
  if (type == 2) return update.bind(1, input.number<double>());
  const std::string_view bytes = input.text();
  if (type == 3) return update.bind(1, std::string(bytes));
  update.bind(1, bytes.data(), static_cast<int>(bytes.size()));
}

void change_record(Input input) {
  constexpr int most_changes = 8;
  SQLite::Database record = small_run().renewed();
  record.exec("BEGIN");
  for (int changes = 0; changes < most_changes && !input.empty(); ++changes) {
    const Column& column = all_columns()[input.below(all_columns().size())];
    const std::size_t row = input.below(16);
    change(record, column, row, [&](SQLite::Statement& update) { bind_value(update, input); });
  }
  record.exec("COMMIT");
}

/// Lets one part of the record be read. That it is refused is no fault.
template <class Read>
void give_to(const Read& read) {
  try {
    read();
  } catch (const InputError&) {
  }
}

void read_individual(const Archive& archive, std::uint32_t id) {
  give_to([&] {
    const ArchivedIndividual individual = archive.known_individual(id);
    Newborn newborn = newborn_of(individual);
    newborn.records = archive.lives(id);
    check_lives(archive, small_run().experiment(), newborn);
  });
  give_to([&] {
    const ArchivedIndividual individual = archive.known_individual(id);
    individual_json(archive, individual);
    check_genes(archive, small_run().experiment(), individual);
  });
}

void read_whole(const Archive& archive) {
  const Experiment& experiment = small_run().experiment();
  give_to([&] {
    const Json shown = run_json(archive, recorded_settings(archive));
    require(embedded(shown) == shown, "what a page embeds reads back as something else");
  });
  give_to([&] { check_objectives(archive, experiment); });
  give_to([&] { check_resumable(archive, experiment); });
  give_to([&] { archive.files(); });
  give_to([&] { archive.immigrants(); });
  give_to([&] { archive.emigrants_to(1, 0); });
  give_to([&] { archive.find_seconds("seconds"); });
  for (std::uint32_t id = 2; id < experiment.evaluations; id += 3) read_individual(archive, id);  // each takes a while
}

}  // namespace

void fuzz(std::string_view input) {
  change_record(Input(input));
  give_to([] { read_whole(Archive::read(small_run().folder())); });
}

}  // namespace evodevo
