// Command-line options that several commands share.
#pragma once

#include "archive/archive.hpp"
#include "commands/shell/command.hpp"
#include "experiment/experiment.hpp"

namespace evodevo {

/// Returns an option with its value, for messages.
std::string option_text(const std::string& option, const std::string& value);

/// Adds --plugin-path.
void add_plugin_option(Options& options);
/// Returns the values of --plugin-path. Throws UsageError if one of them is neither a folder nor a library.
std::vector<std::filesystem::path> given_plugin_path(const Given& given);

/// Throws UsageError if `file`, the output file that `option` names, is one of `inputs`, even if it is named by a
/// different path.
void refuse_to_overwrite(const std::string& option, const std::filesystem::path& file,
                         const std::vector<std::filesystem::path>& inputs);
/// Returns the libraries of an experiment's operators.
std::vector<std::filesystem::path> libraries_of(const Experiment& experiment);
/// Returns the files of the run in `folder`.
std::vector<std::filesystem::path> files_of_run(const std::filesystem::path& folder);

/// Adds --individual, which names one individual.
void add_individual_option(Options& options);

/// Adds --life, which names a life of an individual by its number. `text` says what for.
void add_life_option(Options& options, const char* text);
/// Returns the number of the life that --life names, or nothing without this option.
std::optional<std::int64_t> given_life_number(const Given& given);
/// Returns a life of an individual as a newborn. Throws UsageError, which names --life, if it has had no such life.
Newborn life_of(const Newborn& individual, const Experiment& experiment, std::int64_t number);
/// Returns the life that --life names; the first one without this option.
Newborn given_life(const Newborn& individual, const Experiment& experiment, const Given& given);

/// Adds --scenario, which names a scenario. `text` says what for.
void add_scenario_option(Options& options, const char* text);
/// Returns the index of the scenario that --scenario names, or nothing without this option. Throws UsageError if the
/// experiment has no scenario of this name.
std::optional<std::size_t> given_scenario(const Experiment& experiment, const Given& given);
/// Returns the scenario that --scenario names, for commands on development; null if the option is not given. Throws
/// UsageError if robots do not develop in it.
const Scenario* given_developing_scenario(const Experiment& experiment, const Given& given);

/// Adds --device and --threads.
void add_machine_options(Options& options);
/// Returns the numbers of GPUs that --device gives, as in cuda:0,2; none if it gives none. Throws UsageError.
std::vector<int> given_gpus(const Given& given);
/// Returns the values of --device and --threads as overrides.
std::vector<Override> given_machine(const Given& given);

/// Adds --set, --seed, --plugin-path, --device and --threads.
void add_experiment_options(Options& options);
/// Returns the source of an experiment: `file`, and the values of the options that add_experiment_options() adds.
ExperimentSource experiment_source(const std::string& file, const Given& given);
/// Reads the experiment from experiment_source(). Throws ConfigError.
Experiment given_experiment(const std::string& file, const Given& given);
/// Reads the experiments of all islands of a run (read_islands()).
std::vector<Experiment> given_islands(const std::string& file, const Given& given);
/// Prints warnings on standard error.
void print_warnings(const std::vector<std::string>& warnings);
/// Returns a simulator for the experiment's device.
std::unique_ptr<Simulator> opened_simulator(const Experiment& experiment);
/// Returns the experiment of a run for re-simulation, possibly on a machine without a GPU.
Experiment experiment_of_run(const Archive& archive, const Given& given);

/// Returns the individual with this id. Throws ArchiveError if there is none. `id` may be any number.
ArchivedIndividual individual_named(const Archive& archive, std::int64_t id);
/// Returns the individual that --individual names or, without this option, the best individual. Throws ArchiveError if
/// there is no such individual.
ArchivedIndividual chosen_individual(const Archive& archive, const Given& given);

}  // namespace evodevo
