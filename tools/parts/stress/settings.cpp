#include "settings.hpp"

#include <stdexcept>

namespace evodevo::tools::stress {

boost::program_options::options_description options(Settings& s) {
  namespace po = boost::program_options;
  po::options_description all;
  all.add_options()("folder", po::value(&s.folder));
  all.add_options()("experiment", po::value(&s.experiments));
  all.add_options()("quick", po::bool_switch(&s.quick));
  all.add_options()("robots", po::value(&s.robots));
  all.add_options()("device", po::value(&s.device)->default_value("auto"));
  return all;
}

Settings parse(const CommandLine& line) {
  require_folder(program, line);
  Settings s;
  boost::program_options::positional_options_description names;
  names.add("folder", 1).add("experiment", -1);
  const auto values = read_options(line, options(s), names);
  if (s.experiments.empty()) s.experiments = {"experiments/evo-devo.toml", "experiments/swimmer.toml"};
  if (values.count("robots") == 0) s.robots = s.quick ? 4 : 100;
  if (s.robots == 0) throw std::invalid_argument("--robots 0: expected at least 1");
  s.command = command_of(program, line);
  return s;
}

}  // namespace evodevo::tools::stress
