// Measures how long bodies must be simulated until their least and most stressed springs are known, and writes tables.
#include <iostream>

#include "experiment/device.hpp"
#include "overlap.hpp"
#include "settings.hpp"

namespace evodevo::tools::stress {
namespace {

constexpr double shares[] = {0.5, 0.7, 0.8, 0.9};  // shares of the springs sought

/// Returns a description of the device that the first experiment uses.
std::string device_of(const Settings& settings) {
  const Experiment first =
      read_experiment({settings.experiments.front(), {{"simulation.device", settings.device, ""}}});
  return make_simulator(first)->device();
}

void run(const Settings& settings) {
  std::filesystem::create_directories(settings.folder);
  const std::vector<Case> all = cases(settings.experiments);
  for (const Case& one : all) experiment_of(one, settings.device);  // faults are found before anything is simulated
  write_origin(settings.folder, settings.command, device_of(settings));
  Table table = overlap_table();
  for (const Case& one : all) {
    std::cerr << "stress: " << settings.robots << " robots of " << one.scene << '\n';
    add_rows(one, simulate(one, settings.robots, settings.device), table);
    write(table, settings.folder);
    write(shortest_cycles(table, shares), settings.folder);
  }
  std::cout << shortest_cycles(table, shares).csv();
}

}  // namespace
}  // namespace evodevo::tools::stress

int main(int argc, char** argv) {
  using namespace evodevo::tools;
  return run_program(stress::program, argc, argv, [](const CommandLine& line) { stress::run(stress::parse(line)); });
}
