#include "archive/recorded_experiment.hpp"

#include "archive/record_check.hpp"
#include "base/text.hpp"

namespace evodevo {

namespace fs = std::filesystem;

Settings recorded_settings(const Archive& archive) {
  Settings settings = read_settings(archive.record("experiment"), (archive.folder() / "record of the run").string());
  settings.name = printable(archive.record("name"));
  return settings;
}

Experiment recorded_experiment(const Archive& archive, std::vector<fs::path> plugin_path,
                               std::vector<Override> overrides) {
  Experiment experiment =
      read_experiment(archive.record("experiment"), {.file = (archive.folder() / "record of the run").string(),
                                                     .overrides = std::move(overrides),
                                                     .plugin_path = std::move(plugin_path),
                                                     .is_record = true,
                                                     .files = archive.files()});
  experiment.name = printable(archive.record("name"));
  experiment.island = archive.island();
  if (experiment.island > (experiment.islands ? experiment.islands->count : 0))
    archive.refuse("its entry \"island\" is " + std::to_string(experiment.island) +
                   ", more than the count in [islands] of its experiment");
  check_objectives(archive, experiment);
  return experiment;
}

}  // namespace evodevo
