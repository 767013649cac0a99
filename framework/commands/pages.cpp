// evodevo report, film and gallery: show robots on a page, in a film or in a picture.
#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>

#include "archive/island_folders.hpp"
#include "base/output_file.hpp"
#include "base/text.hpp"
#include "commands/commands.hpp"
#include "commands/shell/options.hpp"
#include "commands/shell/output/notices.hpp"
#include "operators/loader.hpp"
#include "report/camera.hpp"
#include "report/page.hpp"
#include "report/report.hpp"
#include "report/server/local_server.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::array film_endings = {".mp4", ".gif", ".webp", ".png"};

/// Throws UsageError unless the name ends in one of `endings`.
void expect_ending(const std::string& file, std::span<const char* const> endings) {
  if (std::any_of(endings.begin(), endings.end(), [&](const char* ending) { return file.ends_with(ending); })) return;
  throw UsageError("--out " + printable(file) + ": expected a name ending in " +
                   joined(std::vector<std::string>(endings.begin(), endings.end())));
}

void say_size(const std::string& file, std::size_t bytes, const std::string& option) {
  if (verbosity() != Verbosity::quiet) std::cerr << size_note(file, bytes, option);
}

/// Simulates the robots of `cast` again and returns the data of the run for a page.
Json filmed_run(const Archive& archive, const Experiment& experiment, const Given& given, const Cast& cast,
                std::size_t budget) {
  const std::size_t scenario = given_scenario(experiment, given).value_or(0);
  const auto simulator = opened_simulator(experiment);
  return timed("simulating robots of " + printable(archive.folder().string()) + " again",
               [&] { return reported_run(archive, experiment, *simulator, cast, budget, scenario); });
}

Json reported(const std::string& folder, const Given& given, std::size_t budget) {
  const Archive archive = Archive::read(folder);
  Cast cast{.best = static_cast<std::size_t>(given["best"].as<std::int64_t>()),
            .elites = static_cast<std::size_t>(given["elites"].as<std::int64_t>())};
  if (cast.best == 0) cast.best_of_others = 0;
  if (given.contains("individual"))
    for (const std::int64_t id : given["individual"].as<std::vector<std::int64_t>>())
      cast.individuals.push_back(individual_named(archive, id).id);
  const Experiment experiment = experiment_of_run(archive, given);
  refuse_to_overwrite("--out", given["out"].as<std::string>(), libraries_of(experiment));
  return filmed_run(archive, experiment, given, cast, budget);
}

/// Returns the page of all runs, with films of at most page_budget.
std::string reported_page(const std::vector<std::string>& folders, const Given& given) {
  const std::string page = page_template();
  std::vector<Json> runs;
  for (const std::string& folder : folders) runs.push_back(reported(folder, given, page_budget / folders.size()));
  return filled_page(page, report_data(std::move(runs)));
}

/// Returns the number of generations of each run as JSON.
std::string generations_of(const std::vector<std::string>& folders) {
  Json counts = Json::array();
  for (const std::string& folder : folders) counts.push_back(Archive::read(folder).generations().size());
  return counts.dump();
}

/// Loads the library of the server, which stays loaded.
auto loaded_server() {
  const fs::path file = builtin_plugin_folder().parent_path() / "libevodevo-serve.so";
  void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const function = library != nullptr ? dlsym(library, "evodevo_serve_locally") : nullptr;
  if (function == nullptr)
    throw std::runtime_error(std::string("--serve: ") + dlerror() +
                             "; build the target evodevo-serve and install evodevo again, or write a file with --out");
  return reinterpret_cast<decltype(&evodevo_serve_locally)>(function);
}

/// Serves the page of runs. The page is made anew if a run has grown since.
int serve_report(const std::vector<std::string>& folders, const Given& given) {
  const auto port = given["serve"].as<std::int64_t>();
  if (port < 0 || port > 65535)
    throw UsageError("--serve " + std::to_string(port) + ": expected a port, 0 to 65535; 0: any free port");
  if (!given["out"].defaulted())
    throw UsageError("--out " + printable(given["out"].as<std::string>()) +
                     ": --serve writes no file; leave one of the two out");
  constexpr std::string_view place_of_page = "/", place_of_generations = "/generations";
  std::string page, shown;
  const auto document = [&](std::string_view path) -> std::optional<Document> {
    if (path != place_of_page && path != place_of_generations) return std::nullopt;
    const std::string generations = generations_of(folders);
    if (path == place_of_generations) return Document{"application/json", generations};
    if (generations != shown)
      page = self_reloading(reported_page(folders, given), std::string(place_of_generations), generations);
    shown = generations;
    return Document{"text/html; charset=utf-8", page};
  };
  document(place_of_page);  // so that an error in a run ends the command at once
  const auto serve = loaded_server();
  try {
    serve(
        static_cast<std::uint16_t>(port), [](const std::string& address) { std::cout << address << std::endl; },
        document);
  } catch (const PortError& error) {
    throw InputError("--serve " + std::to_string(port) + ": the port cannot be used: " + error.what() +
                     "; give another one, or 0 for any that is free");
  }
  return 0;
}

/// Returns the folders of the archives of runs: of a run with islands, those of all islands.
std::vector<std::string> folders_of_archives(const std::vector<std::string>& runs) {
  std::vector<std::string> folders;
  for (const std::string& run : runs)
    for (const fs::path& folder : archive_folders(run)) folders.push_back(folder.string());
  return folders;
}

int report(const Given& given) {
  const std::vector<std::string> folders = folders_of_archives(given["DIR"].as<std::vector<std::string>>());
  const auto best = given["best"].as<std::int64_t>();
  if (best < 0 || best > 100) throw UsageError("--best " + std::to_string(best) + ": expected 0 to 100");
  const auto elites = given["elites"].as<std::int64_t>();
  if (elites < 0 || elites > 1000) throw UsageError("--elites " + std::to_string(elites) + ": expected 0 to 1000");
  if (given.contains("serve")) return serve_report(folders, given);
  const auto file = given["out"].as<std::string>();
  for (const std::string& folder : folders) refuse_to_overwrite("--out", file, files_of_run(folder));
  viewer_folder();  // so that an unbuilt viewer is reported before a file is begun
  OutputFile output(file, file);
  const std::string filled = reported_page(folders, given);
  output.write(filled);
  output.finish();
  std::cout << file << '\n';
  say_size(file, filled.size(), "--best or --elites");
  return 0;
}

/// Returns the value of an option that takes a time since birth (s), or nullopt if the option is not given. Throws
/// UsageError if the time is negative or not finite.
std::optional<double> given_moment(const Given& given, const char* option) {
  if (!given.contains(option)) return std::nullopt;
  const double moment = given[option].as<double>();
  if (moment >= 0 && std::isfinite(moment)) return moment;
  throw UsageError(std::string("--") + option + " " + to_text(moment) + ": expected a time since birth, 0 s or later");
}

/// Returns the part of a life to show. Throws UsageError if the options contradict each other.
Shooting given_shooting(const Given& given, bool is_picture) {
  const Shooting shooting{given_moment(given, "at"), given_moment(given, "from"), given_moment(given, "to"),
                          verbosity() == Verbosity::quiet};
  if (!is_picture && shooting.at)
    throw UsageError("--at " + to_text(*shooting.at) +
                     ": is the time of a picture; give --out a name ending in .png, or leave --at out");
  if (is_picture && (shooting.from || shooting.to))
    throw UsageError("--from and --to are the times of a film; for a picture, give --at instead");
  if (shooting.from && shooting.to && !(*shooting.from < *shooting.to))
    throw UsageError("--to " + to_text(*shooting.to) + ": expected a time after --from " + to_text(*shooting.from));
  return shooting;
}

int film(const Given& given) {
  const auto file = given["out"].as<std::string>(), folder = given["DIR"].as<std::string>();
  expect_ending(file, film_endings);
  const Shooting shooting = given_shooting(given, file.ends_with(".png"));
  refuse_to_overwrite("--out", file, files_of_run(folder));
  const Archive archive = Archive::read(folder);
  const ArchivedIndividual shown = chosen_individual(archive, given);
  Cast cast = given.contains("individual") ? Cast{.best = 0, .best_of_others = 0, .individuals = {shown.id}}
                                           : Cast{.best = 1, .best_of_others = 0, .ancestors = 0};
  const Experiment experiment = experiment_of_run(archive, given);
  cast.life = given_life(newborn_of(shown), experiment, given).life;
  refuse_to_overwrite("--out", file, libraries_of(experiment));
  const std::string page = page_template();
  OutputFile output(file, file);
  const Json data = report_data({filmed_run(archive, experiment, given, cast, page_budget)});
  timed("drawing " + printable(file), [&] { shoot(filled_page(page, data), output, file, shooting); });
  std::cout << file << '\n';
  return 0;
}

int gallery(const Given& given) {
  const auto count = given["count"].as<std::int64_t>();
  if (count < 1 || count > 1000) throw UsageError("--count " + std::to_string(count) + ": expected 1 to 1000");
  const auto file = given["out"].as<std::string>();
  expect_ending(file, std::array{".html", ".png"});
  const auto experiment_file = given["EXPERIMENT.toml"].as<std::string>();
  refuse_to_overwrite("--out", file, {experiment_file});
  const std::string page = page_template();
  const Experiment experiment = given_experiment(experiment_file, given);
  refuse_to_overwrite("--out", file, libraries_of(experiment));
  OutputFile output(file, file);
  const std::string filled = filled_page(page, gallery_data(experiment, static_cast<std::size_t>(count)));
  if (file.ends_with(".png")) {
    timed("drawing " + printable(file),
          [&] { shoot(filled, output, file, {.quiet = verbosity() == Verbosity::quiet}); });
  } else {
    output.write(filled);
    output.finish();
    say_size(file, filled.size(), "--count");
  }
  std::cout << file << '\n';
  return 0;
}

}  // namespace

Command report_command() {
  Options options;
  options.add_options()("best", value<std::int64_t>("N")->default_value(3),
                        "how many of the best individuals of each run to show")(
      "elites", value<std::int64_t>("N")->default_value(100),
      "how many elites of the map of niches of each run to show, the best first")(
      "individual", values<std::int64_t>("ID"), "another individual of each run to show; may be repeated")(
      "out", value<std::string>("FILE")->default_value("report.html"), "the page to write")(
      "serve", value<std::int64_t>("PORT"),
      "serve the page at http://127.0.0.1:PORT/ instead of writing it; 0: at any free port");
  add_scenario_option(options, "the scenario in which the films end; default: the first");
  add_plugin_option(options);
  return {
      .name = "report",
      .arguments = {{"DIR", Count::one_or_more}},
      .summary = "Write a page that shows runs and their robots",
      .text =
          {"The page is one HTML file that needs neither network nor server. It shows the progress in each objective, "
           "the Pareto front, the experiment, and the best robots, some of their ancestors and the named "
           "individuals in 3D. For several runs, or the islands of a run, it is one page that compares them.",
           "The best robots are those with the best first objective. If there are other objectives, the page also "
           "shows the best robot by each of them. If the experiment has descriptors, it shows the map of their niches, "
           "whose cells open their robots.",
           "With --serve, only this machine can reach the page, which reloads itself when a run has grown; Ctrl-C ends "
           "the command."},
      .examples = {"report runs/quickstart-1 --out report.html", "report runs/quickstart-1 --serve 8080"},
      .options = options,
      .function = report};
}

Command film_command() {
  Options options;
  add_individual_option(options);
  add_life_option(options, "show this life; default: the first");
  options.add_options()("out", value<std::string>("FILE")->default_value("film.mp4"),
                        "the file to write; its name ends in .mp4, .gif, .webp or .png")(
      "from", value<double>("S"), "time at which a film begins, in s since birth; default: at birth")(
      "to", value<double>("S"), "time at which a film ends, in s since birth; default: at the end of the life")(
      "at", value<double>("S"), "time of a picture, in s since birth; default: midway through the last measurement");
  add_scenario_option(options, "the scenario in which the film ends; default: the first");
  add_plugin_option(options);
  return {
      .name = "film",
      .arguments = {{"DIR"}},
      .summary = "Write a film or a picture of a robot of a run",
      .text =
          {"A name ending in .mp4 gives a film of 1280 by 720 pixels and 30 frames a second. A name ending in .webp "
           "or .gif gives an animated picture of 480 by 270 pixels and 20 frames a second for web pages; each second "
           "takes some 0.1 MB as WebP and 0.6 MB as GIF. A name ending in .png gives a single picture.",
           "Chromium draws the frames and ffmpeg encodes them; without a GPU, a frame takes 0.2 to 0.5 s of processor "
           "time."},
      .examples = {"film runs/quickstart-1 --out champion.mp4",
                   "film runs/quickstart-1 --from 14 --to 20 --out walk.webp",
                   "film runs/quickstart-1 --individual 295 --at 14 --out another.png"},
      .options = options,
      .function = film};
}

Command gallery_command() {
  Options options;
  options.add_options()("count", value<std::int64_t>("N")->default_value(24), "how many robots")(
      "out", value<std::string>("FILE")->default_value("gallery.html"),
      "the page to write, or a picture if the name ends in .png");
  add_experiment_options(options);
  return {.name = "gallery",
          .arguments = {{"EXPERIMENT.toml"}},
          .summary = "Write a page of random robots of an experiment",
          .text = {"The page shows how the encoding builds each body."},
          .examples = {"gallery experiments/paper.toml --count 24 --out gallery.html"},
          .options = options,
          .function = gallery};
}

}  // namespace evodevo
