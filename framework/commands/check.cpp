// evodevo check.
#include <algorithm>
#include <cmath>
#include <iostream>

#include "base/text.hpp"
#include "commands/commands.hpp"
#include "commands/shell/options.hpp"
#include "evolution/first_robots.hpp"
#include "evolution/founders.hpp"
#include "experiment/islands/neighbours.hpp"
#include "life/measurement/top_speed.hpp"
#include "life/measurement/windows.hpp"

namespace evodevo {
namespace {

/// Prints how many individuals of another run the experiment begins with, if it names one.
void print_founders(const Experiment& experiment) {
  if (const std::size_t count = founders(experiment).size(); count > 0)
    std::cout << "start: " << count << (count == 1 ? " individual" : " individuals") << " of "
              << printable(experiment.start) << ", and random ones in the places left\n";
}

/// Prints how much memory samples by mass and by spring take, if a fitness operator asks for any.
void print_sample_memory(const Experiment& experiment) {
  constexpr std::size_t masses = 1000, springs = 10'000;
  const Windows windows(experiment, 0);
  const double small = windows.bytes_after_maturing(0, 0) + windows.bytes_within_life(0, 0),
               after = windows.bytes_after_maturing(masses, springs),
               within = windows.bytes_within_life(masses, springs);
  if (!(after + within > small)) return;
  const auto megabytes = [](double bytes) { return short_number(bytes / 1e6) + " MB"; };
  std::cout << "samples: " << megabytes(after) << " after maturing and " << megabytes(within)
            << " within the life, for a robot of " << masses << " masses and " << springs << " springs; at most "
            << megabytes(std::max(after, most_sample_bytes)) << " after maturing at once\n";
}

/// Returns a text such as "0.2" or "0.2 to 0.3".
std::string range_text(double low, double high) {
  const std::string from = short_number(low), to = short_number(high);
  return from == to ? from : from + " to " + to;
}

/// Returns a text such as "0.24 m/s" or, on a slope, "0.3 m/s downhill, and 0.2 m/s uphill,".
std::string top_speed_text(const Scene& scene) {
  const auto [uphill, downhill] = std::minmax({top_speed(scene, -1), top_speed(scene, 1)});
  const std::string fastest = short_number(downhill) + " m/s";
  if (!scene.on_slope()) return fastest;
  return fastest + " downhill, and " + (uphill > 0 ? short_number(uphill) + " m/s" : "nothing") + " uphill,";
}

/// Prints what limits the speed of robots that move by friction. `lengths` are those of some robots, m, in ascending
/// order; `window` is the time during which the first objective is measured, s; 0: it is not a time in this scene.
void print_top_speed(const Scene& scene, const std::vector<double>& lengths, double window) {
  const double fastest = std::max(top_speed(scene, -1), top_speed(scene, 1));
  if (std::isinf(fastest)) {
    std::cout << "there is no damping, so only its muscles limit the speed of a robot\n";
    return;
  }
  std::cout << "friction keeps up at most " << top_speed_text(scene) << " against the damping";
  if (!lengths.empty()) {
    const double low = fastest / lengths.back(), high = fastest / lengths.front();
    std::cout << (scene.on_slope() ? ": downhill " : ": ") << range_text(low, high) << " body lengths per second, ";
    if (window > 0)
      std::cout << "or " << range_text(low * window, high * window) << " in the window of " << short_number(window)
                << " s, ";
    std::cout << "for the first random robots, which are " << range_text(lengths.front(), lengths.back())
              << " m long at birth";
  }
  std::cout << '\n';
}

/// Prints it for each scene in which robots are measured. `lengths` are those of some robots, m, in ascending order.
void print_top_speeds(const Experiment& experiment, const std::vector<double>& lengths) {
  std::vector<std::pair<std::string, const Scene*>> scenes;
  if (experiment.scenarios.empty()) scenes.emplace_back("", &experiment.scene);
  for (const Scenario& scenario : experiment.scenarios)
    scenes.emplace_back(" in scenario " + scenario.name, &scenario.scene);
  std::erase_if(scenes, [](const auto& named) { return !moves_by_friction(*named.second); });
  if (scenes.empty()) return;
  const std::optional<Request> request = first_objective_request(experiment);
  const double window = request && !request->cycle ? request->window : 0;
  for (const auto& [where, scene] : scenes) {
    std::cout << "top speed" << where << ": ";
    print_top_speed(*scene, lengths, window);
  }
}

/// Returns a text such as "1, 2 and 3".
std::string numbers_text(const std::vector<std::int64_t>& numbers) {
  std::vector<std::string> texts;
  for (const std::int64_t number : numbers) texts.push_back(std::to_string(number));
  return joined(texts);
}

/// Prints who sends migrants to whom, and what is different on single islands.
void print_islands(const std::vector<Experiment>& islands) {
  constexpr std::size_t most = 20;
  const std::optional<IslandSettings>& settings = islands.front().islands;
  if (!settings) return;
  const auto names = [](const Experiment& island) {
    std::vector<std::string> texts;
    for (const OperatorUse& use : island.uses)
      if (use.kind == Selection::kind || use.kind == Mutation::kind || use.kind == Crossover::kind)
        texts.push_back(use.name);
    return joined(texts);
  };
  std::cout << settings->count << " islands, topology " << name_of(settings->topology) << '\n';
  for (std::size_t i = 0; i < std::min(most, islands.size()); ++i) {
    const Experiment& island = islands[i];
    std::cout << "island " << island.island << ": seed " << island.seed << ", " << island.evaluations
              << " evaluations, " << names(island) << "; sends to "
              << numbers_text(destinations_of(island.island, *settings)) << '\n';
  }
  if (islands.size() > most) std::cout << "and " << islands.size() - most << " more\n";
}

int check(const Given& given) {
  const auto file = given["EXPERIMENT.toml"].as<std::string>();
  const std::vector<Experiment> islands = given_islands(file, given);
  const Experiment& experiment = islands.front();
  const FirstRobots robots = first_robots(experiment);
  print_warnings(experiment.warnings);
  print_warnings(robots.warnings);
  print_founders(experiment);
  print_sample_memory(experiment);
  print_top_speeds(experiment, robots.lengths);
  print_islands(islands);
  std::cout << file << ": ok\n";
  return 0;
}

}  // namespace

Command check_command() {
  Options options;
  add_experiment_options(options);
  return {.name = "check",
          .arguments = {{"EXPERIMENT.toml"}},
          .summary = "Check an experiment without running it",
          .text = {"It reads the experiment, loads its operators and checks all values. It reports all errors at once; "
                   "each names the place, the value and the remedy. It also prints the top speed that friction and "
                   "damping allow in the scene, and the islands."},
          .examples = {"check experiments/paper.toml", "check my.toml --set experiment.population=100"},
          .options = options,
          .function = check};
}

}  // namespace evodevo
