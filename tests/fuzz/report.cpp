// Texts, each ended by a zero, that become those of a run and of an experiment, from which a report and a gallery are
// made.
#include "report/report.hpp"

#include "archive/archive.hpp"
#include "archive/recorded_experiment.hpp"
#include "base/text.hpp"
#include "experiment/device.hpp"
#include "fuzz/embedded.hpp"
#include "fuzz/small_run.hpp"
#include "fuzz/target.hpp"

namespace evodevo {
namespace {

/// A run, and the columns with its texts, without those that allow only some.
struct Texts {
  SmallRun run;
  std::vector<Column> columns;
  std::unique_ptr<Simulator> simulator = make_simulator(run.experiment());

  Texts() {
    SQLite::Database record = run.renewed();
    columns = columns_of(record);
    std::erase_if(columns, [](const Column& column) {
      return !column.is_text || column.name == "key" || column.name == "status" || column.name == "role";
    });
  }
};

std::string next_text(std::string_view& input) {
  const std::string text(input.substr(0, input.find('\0')));
  input.remove_prefix(std::min(text.size() + 1, input.size()));
  return text;
}

/// Writes texts into the columns of the record in turn, and into a comment of its experiment.
void write_texts(const Texts& texts, std::string_view input) {
  SQLite::Database record = texts.run.renewed();
  record.exec("BEGIN");
  SQLite::Statement comment(record, "UPDATE record SET value = value || '# ' || ? WHERE key = 'experiment'");
  comment.bind(1, next_text(input));
  comment.exec();
  for (std::size_t i = 0; !input.empty(); ++i) {
    const std::string text = next_text(input);
    change(record, texts.columns[i % texts.columns.size()], i / texts.columns.size(),
           [&](SQLite::Statement& update) { update.bind(1, text); });
  }
  record.exec("COMMIT");
}

void require_embedded(const Json& data) {
  require(embedded(data) == data, "what a page embeds reads back as something else");
}

void make_report(const Texts& texts) {
  const Archive archive = Archive::read(texts.run.folder());
  recorded_settings(archive);  // refuses an experiment that is no TOML
  const Cast nobody{.best = 0, .best_of_others = 0, .ancestors = 0};
  require_embedded(report_data({reported_run(archive, texts.run.experiment(), *texts.simulator, nobody, 100'000)}));
}

void make_gallery(const std::string& name) {
  // never destroyed, since the program's end comes too late to call operators
  static Experiment& experiment = *new Experiment(read_experiment(R"(
[experiment]
evaluations = 1
[encoding]
name = "voxel"
size = [1, 1, 1]
edge = 0.5
[[mutation]]
name = "reset-weight"
[[fitness]]
name = "distance"
settle = 0.05
window = 0.1
[selection]
name = "elitist"
)",
                                                                  {"gallery.toml", {}}));
  experiment.name = experiment.context.material_names.front() = printable(name);
  require_embedded(gallery_data(experiment, 1));
}

}  // namespace

void fuzz(std::string_view input) {
  static const Texts texts;
  write_texts(texts, input);
  try {
    make_report(texts);
  } catch (const InputError&) {
  }
  make_gallery(next_text(input));
}

}  // namespace evodevo
