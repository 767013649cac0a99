// The options that `run` and `resume` share.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "commands/run/generation_log.hpp"
#include "commands/run/time_limit.hpp"
#include "commands/shell/command.hpp"
#include "engine/run.hpp"

namespace evodevo {

/// Adds --journal.
void add_journal_option(Options& options);

/// Returns what the options of `run` or `resume` say of the run in a folder. Throws UsageError.
RunSpec given_spec(const Given& given, const std::filesystem::path& folder);
/// Returns events that print warnings and, if verbose, how long steps take.
RunEvents printed_events();

/// Adds --mixed.
void add_mixed_option(Options& options);
/// Adds --allow-other-versions.
void add_versions_option(Options& options);

/// Adds --log, --no-report and --until.
void add_output_options(Options& options);
/// Opens the file of --log. Returns nothing without this option. Throws UsageError if it is one of `inputs`, or the
/// library of an operator.
std::unique_ptr<GenerationLog> given_log(const Given& given, const Experiment& experiment,
                                         const std::vector<std::filesystem::path>& inputs);
/// Returns the limit that --until gives, counted from now, or null.
std::unique_ptr<TimeLimit> given_limit(const Given& given);

}  // namespace evodevo
