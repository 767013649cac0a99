// An experiment with options: lines `--set KEY=VALUE`, and then the text of the file.
#include "experiment/experiment.hpp"

#include "fuzz/target.hpp"

namespace evodevo {

void fuzz(std::string_view input) {
  constexpr std::string_view option = "--set ";
  ExperimentSource source{"input.toml", {}};
  while (input.starts_with(option)) {
    const std::string_view line = input.substr(0, input.find('\n'));
    input.remove_prefix(std::min(line.size() + 1, input.size()));
    const std::string assignment(line.substr(option.size()));
    const std::size_t sign = assignment.find('=');
    if (sign == std::string::npos) continue;
    source.overrides.push_back({assignment.substr(0, sign), assignment.substr(sign + 1), std::string(line)});
  }
  try {
    const Experiment experiment = read_experiment(input, source);
    if (experiment.islands) return;  // the record of an island is read by itself
    const Experiment again = read_experiment(experiment.resolved, {"record.toml", {}});
    require(again.resolved == experiment.resolved, "the record of an experiment reads back as another one");
  } catch (const ConfigError&) {
  }
}

}  // namespace evodevo
