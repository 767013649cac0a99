// Command-line options that several commands share.
#pragma once

#include <boost/program_options.hpp>

#include "commands.hpp"
#include "experiment.hpp"

namespace evodevo {

/// What a command expects.
struct CommandLine {
  std::string usage;  ///< "run EXPERIMENT.toml [options]"
  std::vector<std::string>
      positional;  ///< names of required arguments, in order; one that ends in "..." takes the rest
  boost::program_options::options_description options;
};

/// The values given; empty where --help was asked for and printed. Throws UsageError.
std::optional<boost::program_options::variables_map> parse(CommandLine line, const Arguments& arguments);

/// An id given as a number. Throws UsageError for one that no individual can have.
std::uint32_t individual_id(std::int64_t number);

/// --set, and shorthands for single keys.
void add_experiment_options(boost::program_options::options_description& options);
/// The experiment that `file` and the options above name.
ExperimentSource experiment_source(const std::string& file, const boost::program_options::variables_map& given);

/// The simulator for the experiment's device and threads. Throws ConfigError where CUDA is asked for and not to be had.
std::unique_ptr<Simulator> make_simulator(const Experiment& experiment);

}  // namespace evodevo
