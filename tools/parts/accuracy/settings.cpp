#include "settings.hpp"

#include <stdexcept>

#include "studies.hpp"

namespace evodevo::tools::accuracy {
namespace {

constexpr std::size_t fewest_robots = 20;  // size of the groups in which the best robot is searched for

std::vector<std::string> all_studies() {
  std::vector<std::string> names;
  for (const Study& study : studies) names.emplace_back(study.name);
  return names;
}

void check(const Settings& s) {
  for (const std::string& study : s.studies) check_choice("study", study, all_studies());
  check_device(s.device.name);
  if (s.robots < fewest_robots)
    throw std::invalid_argument("--robots " + std::to_string(s.robots) + ": expected at least " +
                                std::to_string(fewest_robots) + ", so that there are best ones to find");
}

}  // namespace

boost::program_options::options_description options(Settings& s) {
  namespace po = boost::program_options;
  po::options_description all;
  all.add_options()("folder", po::value(&s.folder));
  all.add_options()("quick", po::bool_switch(&s.quick));
  all.add_options()("study", po::value(&s.studies)->composing());
  all.add_options()("device", po::value(&s.device.name)->default_value("cpu"));
  all.add_options()("threads", po::value(&s.device.threads)->default_value(0));
  all.add_options()("experiment", po::value(&s.experiment)->default_value("experiments/study/accuracy/robots.toml"));
  all.add_options()("robots", po::value(&s.robots));
  return all;
}

Settings parse(const CommandLine& line) {
  require_folder(program, line);
  Settings s;
  const auto values =
      read_options(line, options(s), boost::program_options::positional_options_description().add("folder", 1));
  if (s.studies.empty()) s.studies = all_studies();
  if (values.count("robots") == 0) s.robots = s.quick ? 24 : 500;
  check(s);
  s.command = command_of(program, line);
  return s;
}

}  // namespace evodevo::tools::accuracy
