#include "commands/run/run_options.hpp"

#include "commands/shell/options.hpp"
#include "commands/shell/output/notices.hpp"

namespace evodevo {

namespace fs = std::filesystem;

namespace {

/// Returns the value of --journal, or nullopt if the option is not given.
std::optional<Journal> given_journal(const Given& given) {
  if (!given.contains("journal")) return std::nullopt;
  const auto text = given["journal"].as<std::string>();
  const auto journal = journal_named(text);
  if (!journal) throw UsageError("--journal " + text + ": expected wal or delete");
  return journal;
}

}  // namespace

void add_journal_option(Options& options) {
  options.add_options()(
      "journal", value<std::string>("wal|delete"),
      "journal mode of SQLite: with wal, the run and its readers never wait for each other; delete also "
      "works on network file systems; default: wal if the file system can do it");
}

RunSpec given_spec(const Given& given, const fs::path& folder) {
  return {.folder = folder,
          .journal = given_journal(given),
          .plugin_path = given_plugin_path(given),
          .machine = given_machine(given),
          .gpus = given_gpus(given),
          .other_versions = given.contains("allow-other-versions"),
          .mixed = given.contains("mixed")};
}

RunEvents printed_events() {
  return {.warning = [](const std::string& warning) { print_warnings({warning}); },
          .step = [](const std::string& what, const std::function<void()>& work) { timed(what, work); }};
}

void add_mixed_option(Options& options) {
  options.add_options()(
      "mixed",
      "let ranks have different devices and builds; the run records with which of them each individual was evaluated");
}

void add_versions_option(Options& options) {
  options.add_options()("allow-other-versions",
                        "continue even if an operator has another version than when the run began");
}

void add_output_options(Options& options) {
  options.add_options()("log", value<std::string>("FILE"), "append one JSON object for each generation to this file");
  options.add_options()("no-report", "do not write report.html when the run is finished");
  options.add_options()(
      "until", value<std::string>("TIME"),
      "be done after this time, such as 90m or 11.5h, or at a local time, such as 2030-01-31T18:30: begin no "
      "generation that would not leave time to verify the best and to write the page; `resume` continues the run");
}

std::unique_ptr<GenerationLog> given_log(const Given& given, const Experiment& experiment,
                                         const std::vector<fs::path>& inputs) {
  if (!given.contains("log")) return nullptr;
  const auto file = given["log"].as<std::string>();
  refuse_to_overwrite("--log", file, inputs);
  refuse_to_overwrite("--log", file, libraries_of(experiment));
  return std::make_unique<GenerationLog>(file);
}

std::unique_ptr<TimeLimit> given_limit(const Given& given) {
  if (!given.contains("until")) return nullptr;
  const TimeLimit::Clock::time_point begin = TimeLimit::Clock::now();
  return std::make_unique<TimeLimit>(begin, end_given_by(given["until"].as<std::string>()));
}

}  // namespace evodevo
