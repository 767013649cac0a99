// evodevo run-many.
#include <algorithm>
#include <atomic>
#include <fstream>
#include <iostream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/input_file.hpp"
#include "base/text.hpp"
#include "cluster/ranks.hpp"
#include "commands/commands.hpp"
#include "commands/run/early_end.hpp"
#include "commands/run/run.hpp"
#include "commands/shell/output/complaint.hpp"
#include "commands/shell/output/output_of_thread.hpp"
#include "experiment/device.hpp"
#include "threads/parallel.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_bytes = 64 << 20;  // of the file of runs

/// The number of runs that are made at once: as the user says, otherwise one for each core.
std::size_t given_jobs(const Given& given) {
  if (!given.contains("jobs")) return static_cast<std::size_t>(thread_count(0));
  const int jobs = given["jobs"].as<int>();
  if (jobs < 1) throw UsageError("--jobs " + std::to_string(jobs) + ": expected a whole number of at least 1");
  return static_cast<std::size_t>(jobs);
}

/// Reads the arguments of a run. `place` names the line, for errors.
Arguments arguments_in(const std::string& line, const std::string& place) {
  const auto json = nlohmann::json::parse(line, nullptr, false);
  const auto is_text = [](const auto& item) { return item.is_string(); };
  if (!json.is_array() || json.empty() || !std::ranges::all_of(json, is_text))
    throw UsageError(place +
                     ": expected a JSON array of texts, the arguments of one `run`, such as [\"evo.toml\", \"--seed\", "
                     "\"2\", \"--out\", \"runs/2\"]");
  return json.get<Arguments>();
}

/// Returns the values of the arguments of a line. A run whose arguments do not say how many threads it uses has
/// `threads`.
Given read_line(Arguments arguments, const std::string& place, std::size_t threads) {
  const auto is_about_threads = [](const std::string& word) {
    return word.starts_with("--threads") || word.find("simulation.threads=") != std::string::npos;
  };
  if (std::ranges::none_of(arguments, is_about_threads))
    arguments.insert(arguments.end(), {"--threads", std::to_string(threads)});
  Given given;
  try {
    given = parse(run_command(), arguments);
  } catch (const UsageError& error) {
    throw UsageError(place + ": " + error.what());
  }
  if (!given.contains("out") || given["out"].as<std::string>().empty())
    throw UsageError(place + ": --out: missing or empty; give each run a folder");
  for (const char* option : {"help", "until"})
    if (given.contains(option)) throw UsageError(place + ": --" + option + ": is for a single run; leave it out");
  return given;
}

/// The threads of each of several runs that are made at once. They share the cores; the number is rounded up, because
/// runs often wait for a GPU.
std::size_t threads_of_each(std::size_t runs) {
  const auto cores = static_cast<std::size_t>(thread_count(0));
  return (cores + runs - 1) / runs;
}

/// Returns the absolute path of a folder, without a slash at the end.
fs::path without_slash(const fs::path& folder) { return fs::absolute(folder / "").parent_path(); }

/// Reads the runs in a file, of which at most `jobs` are made at once.
std::vector<Given> read_runs(const std::string& file, std::size_t jobs) {
  std::istringstream text(read_input_file(file, most_bytes));
  std::vector<std::pair<std::string, Arguments>> lines;  // with their places
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    const std::string place = printable(file) + ':' + std::to_string(number);
    if (!line.empty()) lines.emplace_back(place, arguments_in(line, place));
  }
  if (lines.empty()) throw UsageError(printable(file) + ": has no runs; give a file with a line for each run");
  const std::size_t threads = threads_of_each(std::min(jobs, lines.size()));
  std::vector<Given> runs;
  std::map<fs::path, std::string> places;  // of the lines, by their folders
  for (auto& [place, arguments] : lines) {
    runs.push_back(read_line(std::move(arguments), place, threads));
    const fs::path folder = runs.back()["out"].as<std::string>();
    std::error_code error;
    const fs::path canonical = fs::weakly_canonical(without_slash(folder), error);
    if (const auto [other, is_new] = places.emplace(error ? folder : canonical, place); !is_new)
      throw UsageError(place + ": --out " + printable(folder.string()) + ": is the folder of " + other->second +
                       ", too; give each run a folder of its own");
  }
  return runs;
}

/// Returns the file for what a run in a folder prints.
fs::path log_of(const fs::path& folder) { return without_slash(folder) += ".log"; }

/// Makes a run, and returns its exit code.
int made(const Given& run) {
  const fs::path log = log_of(run["out"].as<std::string>());
  std::error_code error;
  fs::create_directories(log.parent_path(), error);
  std::ofstream stream(log, std::ios::app);
  if (!stream) {
    std::cerr << "evodevo: " + printable(log.string()) + ": cannot be written; give the run another --out\n";
    return 2;
  }
  const OutputOfThread output(stream.rdbuf());
  return or_complain([&] { return make_run(run); });
}

int run_many(const Given& given) {
  if (started_processes() > 1)
    throw UsageError("run-many: it makes its runs in one process; start it without mpirun or srun");
  stop_on_signals();
  never_end_on_signals();
  const std::size_t jobs = given_jobs(given);
  const std::vector<Given> runs = read_runs(given["FILE"].as<std::string>(), jobs);
  usable_gpus();  // prepares the environment for the driver before there are other threads
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  bool has_failed = false;
  on_own_threads(std::min(jobs, runs.size()), [&](std::size_t) {
    for (std::size_t i = next++; i < runs.size() && !stop_requested(); i = next++) {
      const int code = made(runs[i]);
      const std::lock_guard lock(mutex);
      std::cout << nlohmann::ordered_json{{"run", i}, {"exit_code", code}}.dump() << std::endl;
      has_failed |= code != 0 && code != no_fitness;
    }
  });
  return stop_requested() ? ended_early : has_failed ? 1 : 0;
}

}  // namespace

Command run_many_command() {
  Options options;
  options.add_options()("jobs", value<int>("N"), "runs at once; default: one for each core");
  return {
      .name = "run-many",
      .arguments = {{"FILE"}},
      .summary = "Make many runs in one process",
      .text =
          {"The runs share the GPUs, so that small populations keep them busy together. FILE has a line for each run: "
           "a JSON array with the arguments of `run`. What a run prints goes to the file OUT.log beside its folder "
           "OUT. When a run has ended, a JSON object with its number, counted from 0, and its exit code is printed. "
           "A run that fails does not end the others. SIGINT, SIGTERM and SIGUSR1 end all runs after their "
           "generations."},
      .examples = {"run-many runs.jsonl --jobs 16"},
      .options = options,
      .function = run_many};
}

}  // namespace evodevo
