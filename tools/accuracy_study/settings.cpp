#include "settings.hpp"

#include <algorithm>
#include <boost/program_options.hpp>
#include <iostream>
#include <stdexcept>

#include "studies.hpp"

namespace evodevo::accuracy {
namespace {

constexpr std::size_t fewest_robots = 20;  // of which the best is looked for

void check(const Settings& s) {
  if (s.folder.empty() || s.folder.string().starts_with('-'))
    throw std::invalid_argument("name the folder for data and charts first, as in tools/accuracy charts --quick");
  for (const std::string& study : s.studies)
    if (std::none_of(studies.begin(), studies.end(), [&](const Study& known) { return known.name == study; })) {
      std::string names;
      for (const Study& known : studies) names += (names.empty() ? "" : ", ") + std::string(known.name);
      throw std::invalid_argument("--study \"" + study + "\" is none of " + names);
    }
  if (s.device.name != "cpu" && s.device.name != "cuda")
    throw std::invalid_argument("--device \"" + s.device.name + "\" is none of cpu, cuda");
#ifndef EVODEVO_CUDA
  if (s.device.name == "cuda")
    throw std::invalid_argument("this program was built without CUDA; configure with -DEVODEVO_CUDA=ON");
#endif
  if (s.robots < fewest_robots)
    throw std::invalid_argument("--robots must be at least " + std::to_string(fewest_robots) +
                                ", of which the best is looked for");
}

std::vector<std::string> all_studies() {
  std::vector<std::string> names;
  for (const Study& study : studies) names.emplace_back(study.name);
  return names;
}

}  // namespace

std::optional<Settings> parse(int argc, const char* const* argv) {
  namespace po = boost::program_options;
  Settings s;
  po::options_description options(
      "tools/accuracy FOLDER [options] studies how accurate, fast and stable the time-stepping methods are. Options");
  options.add_options()("help", "this text");
  options.add_options()("folder", po::value(&s.folder), "for data and charts; may be named without --folder");
  options.add_options()("quick", po::bool_switch(&s.quick),
                        "a minute on two cores: fewer steps, robots and shorter lives");
  options.add_options()(
      "study", po::value(&s.studies)->composing(),
      "work-precision | beam | ranking | orders | energy | stability | features; may be given several "
      "times; by default all");
  options.add_options()("device", po::value(&s.device.name)->default_value("cpu"),
                        "cpu | cuda: where bodies are moved; references, orders, energy and limits of dt are always "
                        "worked out on the CPU");
  options.add_options()("threads", po::value(&s.device.threads)->default_value(0), "threads; 0: all cores");
  options.add_options()("experiment", po::value(&s.experiment)->default_value("experiments/quickstart.toml"),
                        "whose random robots are ranked, as they are born");
  options.add_options()("robots", po::value(&s.robots), "how many of them; by default 500, with --quick 24");
  po::positional_options_description folder;
  folder.add("folder", 1);
  po::variables_map values;
  po::store(po::command_line_parser(argc, argv).options(options).positional(folder).run(), values);
  po::notify(values);
  if (values.count("help")) {
    std::cout << options;
    return std::nullopt;
  }
  if (s.studies.empty()) s.studies = all_studies();
  if (values.count("robots") == 0) s.robots = s.quick ? 24 : 500;
  check(s);
  s.command = "tools/accuracy";
  for (int i = 1; i < argc; ++i) s.command += std::string(" ") + argv[i];
  return s;
}

}  // namespace evodevo::accuracy
