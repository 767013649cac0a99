// Command-line options that several commands share.
#pragma once

#include <boost/program_options.hpp>

#include "archive.hpp"
#include "commands.hpp"
#include "experiment.hpp"

namespace evodevo {

/// What a command expects.
struct CommandLine {
  std::string usage;                    ///< "run EXPERIMENT.toml [options]"
  std::vector<std::string> positional;  ///< names of required arguments, in order
  boost::program_options::options_description options;
  std::string repeated = {};  ///< the option that takes all arguments behind the required ones
};

/// The values given; empty where --help was asked for and printed. Throws UsageError.
std::optional<boost::program_options::variables_map> parse(CommandLine line, const Arguments& arguments);

/// --plugin-path.
void add_plugin_option(boost::program_options::options_description& options);
/// What --plugin-path names. Throws UsageError where there is neither a folder nor a library.
std::vector<std::filesystem::path> given_plugin_path(const boost::program_options::variables_map& given);

/// --set, --plugin-path, and shorthands for single keys.
void add_experiment_options(boost::program_options::options_description& options);
/// The experiment that `file` and the options above name.
ExperimentSource experiment_source(const std::string& file, const boost::program_options::variables_map& given);

/// Throws ArchiveError where there is no individual `id`, which may be any number.
ArchivedIndividual individual_named(const Archive& archive, std::int64_t id);
/// The individual that --individual names, or else the best. Throws ArchiveError where there is none.
ArchivedIndividual chosen_individual(const Archive& archive, const boost::program_options::variables_map& given);

}  // namespace evodevo
