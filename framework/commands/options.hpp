// Command-line options that several commands share.
#pragma once

#include <boost/program_options.hpp>

#include "commands.hpp"
#include "evolution/archive.hpp"
#include "experiment/experiment.hpp"

namespace evodevo {

/// What a command expects.
struct CommandLine {
  std::string usage;                    ///< "run EXPERIMENT.toml [options]"
  std::vector<std::string> positional;  ///< names of required arguments, in order
  boost::program_options::options_description options;
  std::string repeated = {};  ///< the option that takes all arguments behind the required ones
};

/// The values given; empty where --help was asked for and printed. Throws UsageError, also where what the command
/// prints would go into a file that it reads.
std::optional<boost::program_options::variables_map> parse(CommandLine line, const Arguments& arguments);

/// --plugin-path.
void add_plugin_option(boost::program_options::options_description& options);
/// What --plugin-path names. Throws UsageError where there is neither a folder nor a library.
std::vector<std::filesystem::path> given_plugin_path(const boost::program_options::variables_map& given);

/// Throws UsageError where `file`, which `option` wants to write, is one of `inputs`, by whatever name.
void refuse_to_overwrite(const std::string& option, const std::filesystem::path& file,
                         const std::vector<std::filesystem::path>& inputs);
/// What is read of an experiment beside its file: the libraries of its operators.
std::vector<std::filesystem::path> libraries_of(const Experiment& experiment);
/// The files of a run in `folder`.
std::vector<std::filesystem::path> files_of_run(const std::filesystem::path& folder);

/// --set, --plugin-path, and shorthands for single keys.
void add_experiment_options(boost::program_options::options_description& options);
/// The experiment that `file` and the options above name.
ExperimentSource experiment_source(const std::string& file, const boost::program_options::variables_map& given);

/// Throws ArchiveError where there is no individual `id`, which may be any number.
ArchivedIndividual individual_named(const Archive& archive, std::int64_t id);
/// The individual that --individual names, or else the best. Throws ArchiveError where there is none.
ArchivedIndividual chosen_individual(const Archive& archive, const boost::program_options::variables_map& given);

}  // namespace evodevo
