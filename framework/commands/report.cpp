// evodevo report: runs and their robots as one page.
#include "report/report.hpp"

#include <iostream>

#include "base/output_file.hpp"
#include "commands/options.hpp"
#include "evolution/resimulation.hpp"
#include "experiment/device.hpp"
#include "report/page.hpp"

namespace evodevo {

namespace po = boost::program_options;

namespace {

nlohmann::ordered_json reported(const std::string& folder, const po::variables_map& given, std::size_t budget) {
  const Archive archive = Archive::read(folder);
  Cast cast{.best = static_cast<std::size_t>(given["best"].as<std::int64_t>())};
  if (given.contains("individual"))
    for (const std::int64_t id : given["individual"].as<std::vector<std::int64_t>>())
      cast.individuals.push_back(individual_named(archive, id).id);
  const Experiment experiment = experiment_to_live_again(archive, given_plugin_path(given));
  refuse_to_overwrite("--out", given["out"].as<std::string>(), libraries_of(experiment));
  const auto simulator = make_simulator(experiment);
  return reported_run(archive, experiment, *simulator, cast, budget);
}

}  // namespace

int report_command(const Arguments& arguments) {
  CommandLine line{"report DIR... [--best N] [--individual ID]... [--out FILE] [--plugin-path P]", {}, {}};
  line.options.add_options()("runs", po::value<std::vector<std::string>>(), "folders of the runs to show")(
      "best", po::value<std::int64_t>()->default_value(3), "champions to show, of each run")(
      "individual", po::value<std::vector<std::int64_t>>(), "id of one more to show, of each run; may be repeated")(
      "out", po::value<std::string>()->default_value("report.html"), "the page to write");
  line.repeated = "runs";
  add_plugin_option(line.options);
  const auto given = parse(std::move(line), arguments);
  if (!given) return 0;
  if (!given->contains("runs")) throw UsageError("report: give the folder of a run, or of several");
  const auto folders = (*given)["runs"].as<std::vector<std::string>>();
  const auto best = (*given)["best"].as<std::int64_t>();
  if (best < 0 || best > 100) throw UsageError("--best " + std::to_string(best) + ": expected 0 to 100");
  const auto file = (*given)["out"].as<std::string>();
  for (const std::string& folder : folders) refuse_to_overwrite("--out", file, files_of_run(folder));
  const std::string page = page_template();
  OutputFile output(file, file);
  std::vector<nlohmann::ordered_json> runs;
  for (const std::string& folder : folders) runs.push_back(reported(folder, *given, page_budget / folders.size()));
  const std::string filled = filled_page(page, report_data(std::move(runs)));
  output.write(filled);
  output.finish();
  std::cout << file << '\n';
  std::cerr << size_note(file, filled.size(), "--best");
  return 0;
}

}  // namespace evodevo
