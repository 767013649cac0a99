// Command-line options that several commands share.
#pragma once

#include "commands/shell/command.hpp"
#include "evolution/archive/archive.hpp"
#include "experiment/experiment.hpp"

namespace evodevo {

/// --plugin-path.
void add_plugin_option(Options& options);
/// What --plugin-path names. Throws UsageError where there is neither a folder nor a library.
std::vector<std::filesystem::path> given_plugin_path(const Given& given);

/// Throws UsageError where `file`, which `option` wants to write, is one of `inputs`, by whatever name.
void refuse_to_overwrite(const std::string& option, const std::filesystem::path& file,
                         const std::vector<std::filesystem::path>& inputs);
/// What is read of an experiment beside its file: the libraries of its operators.
std::vector<std::filesystem::path> libraries_of(const Experiment& experiment);
/// The files of a run in `folder`.
std::vector<std::filesystem::path> files_of_run(const std::filesystem::path& folder);

/// --individual, which names one individual.
void add_individual_option(Options& options);

/// --set, --plugin-path, and shorthands for single keys.
void add_experiment_options(Options& options);
/// Where the experiment that `file` and the options above name is read from.
ExperimentSource experiment_source(const std::string& file, const Given& given);
/// Reads that experiment. Throws ConfigError.
Experiment given_experiment(const std::string& file, const Given& given);
/// The simulator for the experiment's device.
std::unique_ptr<Simulator> opened_simulator(const Experiment& experiment);
/// The experiment of a run, which is to be simulated again where its GPU may be missing.
Experiment experiment_of_run(const Archive& archive, const Given& given);

/// Throws ArchiveError where there is no individual `id`, which may be any number.
ArchivedIndividual individual_named(const Archive& archive, std::int64_t id);
/// The individual that --individual names, or else the best. Throws ArchiveError where there is none.
ArchivedIndividual chosen_individual(const Archive& archive, const Given& given);

}  // namespace evodevo
