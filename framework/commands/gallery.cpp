// evodevo gallery: random robots of an experiment's encoding as one page or picture.
#include <iostream>

#include "commands/options.hpp"
#include "report/camera.hpp"
#include "report/page.hpp"
#include "report/report.hpp"

namespace evodevo {

namespace po = boost::program_options;

int gallery_command(const Arguments& arguments) {
  CommandLine line{"gallery EXPERIMENT.toml [--count N] [--out FILE] [options]", {"EXPERIMENT.toml"}, {}};
  line.options.add_options()("count", po::value<std::int64_t>()->default_value(24), "random robots")(
      "out", po::value<std::string>()->default_value("gallery.html"),
      "the page to write; a name ending in .png: a picture");
  add_experiment_options(line.options);
  const auto given = parse(std::move(line), arguments);
  if (!given) return 0;
  const auto count = (*given)["count"].as<std::int64_t>();
  if (count < 1 || count > 1000) throw UsageError("--count " + std::to_string(count) + ": expected 1 to 1000");
  const auto file = (*given)["out"].as<std::string>();
  if (!file.ends_with(".html") && !file.ends_with(".png"))
    throw UsageError("--out " + file + ": expected a name ending in .html or .png");
  const auto experiment_file = (*given)["EXPERIMENT.toml"].as<std::string>();
  refuse_to_overwrite("--out", file, {experiment_file});
  const std::string page = page_template();
  const Experiment experiment = read_experiment(experiment_source(experiment_file, *given));
  refuse_to_overwrite("--out", file, libraries_of(experiment));
  OutputFile output(file, file);
  const std::string filled = filled_page(page, gallery_data(experiment, static_cast<std::size_t>(count)));
  if (file.ends_with(".png")) {
    shoot(filled, output, file, std::nullopt);
  } else {
    output.write(filled);
    output.finish();
    std::cerr << size_note(file, filled.size(), "--count");
  }
  std::cout << file << '\n';
  return 0;
}

}  // namespace evodevo
