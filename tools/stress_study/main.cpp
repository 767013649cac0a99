// Writes how soon it is known which springs are stressed.
#include <boost/program_options.hpp>
#include <iostream>
#include <optional>

#include "base/output_file.hpp"
#include "base/standard_streams.hpp"
#include "experiment/device.hpp"
#include "overlap.hpp"

namespace evodevo::stress_study {
namespace {

constexpr double shares[] = {0.5, 0.7, 0.8, 0.9};  // of the springs that are sought

struct Settings {
  std::string command;  ///< the line itself
  std::filesystem::path folder;
  std::vector<std::string> experiments;
  std::size_t robots = 0;
  std::string device;
};

/// Nothing where the line asks for help, which is printed.
std::optional<Settings> parse(int argc, const char* const* argv) {
  namespace po = boost::program_options;
  Settings s;
  bool quick = false;
  po::options_description options(
      "tools/stress FOLDER [EXPERIMENT.toml]... [options] finds the shortest cycle after which the least and the most "
      "stressed springs are known: those of the first 10 s, of which the cycle is the beginning. Robots are random, "
      "with "
      "a muscle and 1,250 springs at least. Options");
  options.add_options()("help", "this text");
  options.add_options()("folder", po::value(&s.folder), "for data and the chart; may be named without --folder");
  options.add_options()("experiment", po::value(&s.experiments),
                        "whose robots and scenes; may be named without --experiment; by default "
                        "experiments/evo-devo.toml (walkers) and experiments/swimmer.toml; the robots of the first are "
                        "simulated with still muscles, too");
  options.add_options()("quick", po::bool_switch(&quick), "half a minute on two cores: fewer robots");
  options.add_options()("robots", po::value(&s.robots), "of each scene; by default 100, with --quick 4");
  options.add_options()("device", po::value(&s.device)->default_value("auto"), "auto | cpu | cuda");
  po::positional_options_description names;
  names.add("folder", 1).add("experiment", -1);
  po::variables_map values;
  po::store(po::command_line_parser(argc, argv).options(options).positional(names).run(), values);
  po::notify(values);
  if (values.count("help")) {
    std::cout << options;
    return std::nullopt;
  }
  if (s.folder.empty() || s.folder.string().starts_with('-') || s.folder.extension() == ".toml")
    throw std::invalid_argument("name the folder for data and the chart first, as in tools/stress charts --quick");
  if (s.experiments.empty()) s.experiments = {"experiments/evo-devo.toml", "experiments/swimmer.toml"};
  if (values.count("robots") == 0) s.robots = quick ? 4 : 100;
  if (s.robots == 0) throw std::invalid_argument("--robots 0: expected at least 1");
  s.command = "tools/stress";
  for (int i = 1; i < argc; ++i) s.command += std::string(" ") + argv[i];
  return s;
}

/// What made the tables, so that anyone can repeat it.
void write_origin(const Settings& settings) {
  const Experiment first =
      read_experiment({settings.experiments.front(), {{"simulation.device", settings.device, ""}}});
  write_file(settings.folder / "origin.txt", settings.command + '\n' + make_simulator(first)->device() + '\n');
}

void run(const Settings& settings) {
  std::filesystem::create_directories(settings.folder);
  accuracy::Table table = overlap_table();
  for (const Case& one : cases(settings.experiments)) {
    std::cerr << "stress: " << settings.robots << " robots of " << one.scene << '\n';
    add_rows(one, simulate(one, settings.robots, settings.device), table);
  }
  const accuracy::Table shortest = shortest_cycles(table, shares);
  accuracy::write(table, settings.folder);
  accuracy::write(shortest, settings.folder);
  write_origin(settings);
  std::cout << shortest.csv();
}

}  // namespace
}  // namespace evodevo::stress_study

int main(int argc, char** argv) {
  evodevo::open_standard_streams();
  try {
    if (const auto settings = evodevo::stress_study::parse(argc, argv)) evodevo::stress_study::run(*settings);
    evodevo::finish_standard_output();
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "stress: " << error.what() << '\n';
    return 2;
  }
}
