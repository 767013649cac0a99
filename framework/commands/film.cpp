// evodevo film: one robot as a film or a picture.
#include <cmath>
#include <iostream>

#include "base/text.hpp"
#include "commands/options.hpp"
#include "evolution/resimulation.hpp"
#include "experiment/device.hpp"
#include "report/camera.hpp"
#include "report/page.hpp"
#include "report/report.hpp"

namespace evodevo {

namespace po = boost::program_options;

int film_command(const Arguments& arguments) {
  CommandLine line{"film DIR [--individual ID] [--at S] [--out FILE] [--plugin-path P]", {"DIR"}, {}};
  line.options.add_options()("individual", po::value<std::int64_t>(), "its id; default: the best")(
      "at", po::value<double>(), "of a picture: the moment since birth, s; default: midway in the last measurement")(
      "out", po::value<std::string>()->default_value("film.mp4"),
      "the film to write, 30 frames a second, each of which takes 0.2 to 0.5 s of processor time where there is no "
      "GPU; a name ending in .png: a picture");
  add_plugin_option(line.options);
  const auto given = parse(std::move(line), arguments);
  if (!given) return 0;
  const auto file = (*given)["out"].as<std::string>();
  const bool picture = file.ends_with(".png");
  if (!picture && !file.ends_with(".mp4"))
    throw UsageError("--out " + file + ": expected a name ending in .mp4 or .png");
  if (!picture && given->contains("at"))
    throw UsageError("--at is the moment of a picture; give --out a name ending in .png, or leave --at out");
  // written so that NaN fails
  if (given->contains("at"))
    if (const double at = (*given)["at"].as<double>(); !(at >= 0 && std::isfinite(at)))
      throw UsageError("--at " + to_text(at) + ": expected a moment since birth, 0 s or later");
  refuse_to_overwrite("--out", file, files_of_run((*given)["DIR"].as<std::string>()));
  const std::string page = page_template();
  const Archive archive = Archive::read((*given)["DIR"].as<std::string>());
  const ArchivedIndividual shown = chosen_individual(archive, *given);
  const Cast cast =
      given->contains("individual") ? Cast{.best = 0, .individuals = {shown.id}} : Cast{.best = 1, .ancestors = 0};
  const Experiment experiment = experiment_to_live_again(archive, given_plugin_path(*given));
  refuse_to_overwrite("--out", file, libraries_of(experiment));
  OutputFile output(file, file);
  const auto simulator = make_simulator(experiment);
  auto data = report_data({reported_run(archive, experiment, *simulator, cast, page_budget)});
  shoot(filled_page(page, data), output, file,
        given->contains("at") ? std::optional((*given)["at"].as<double>()) : std::nullopt);
  std::cout << file << '\n';
  return 0;
}

}  // namespace evodevo
