// How well the paper's tallies agree with exact stress (paper, Figure 3).
#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "analysis/ground.hpp"
#include "common/agreement.hpp"
#include "common/robots.hpp"
#include "cuda/runtime/cuda_simulator.hpp"
#include "paper/paper_simulator.hpp"
#include "paper/stress_methods.hpp"
#include "studies.hpp"

namespace evodevo::tools::bench {
namespace {

constexpr std::size_t sought = 125;                         // number of springs at either end (paper, section IV-D4)
constexpr std::size_t least_springs = 2000;                 // of each robot, so that 125 are a small share
constexpr std::uint64_t second = 2000;                      // number of steps of 0.5 ms
constexpr std::uint64_t windows[] = {second, 10 * second};  // numbers of steps from birth on

/// Two scores for each spring: the least stressed springs have the largest scores in `least`, the most stressed ones in
/// `most`.
struct Ranking {
  std::vector<double> least, most;
};

Ranking ranking(const std::vector<double>& stress) {
  Ranking ranks{stress, stress};
  for (double& value : ranks.least) value = -value;
  return ranks;
}

Ranking ranking(const RecordedStress& recorded, StressMethod method) {
  if (method == StressMethod::sums) return ranking(recorded.sum);
  return {{recorded.least.begin(), recorded.least.end()}, {recorded.most.begin(), recorded.most.end()}};
}

using Rankings = std::vector<Ranking>;  // one for each robot

/// Ranks the springs of all robots by their exact stress over `steps` steps from birth, computed by our simulator.
Rankings exact_rankings(const Settings& settings, const Scene& scene, const std::vector<Body>& robots,
                        std::uint64_t steps) {
  const auto simulator = make_cuda_simulator(scene, settings.stepping());
  std::vector<State> states;
  for (const Body& robot : robots) states.push_back(state_at_birth(robot, scene));
  std::vector<Task> tasks(robots.size());
  for (std::size_t i = 0; i < tasks.size(); ++i)
    tasks[i] = {.body = &robots[i], .state = &states[i], .dt = time_step, .steps = steps};
  simulator->run(tasks, {.stress = true});
  Rankings rankings;
  for (const Task& task : tasks) {
    if (task.status != Status::ok) throw std::runtime_error("a robot has diverged: " + task.reason);
    rankings.push_back(ranking(task.stress));
  }
  return rankings;
}

/// Adds to a row the shares of the springs sought that the estimate finds, as means over all robots.
void add_shares(const Rankings& truth, const Rankings& estimate, const std::string& window, Report& row) {
  double least = 0, most = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    least += share_found(truth[i].least, estimate[i].least, sought) / static_cast<double>(truth.size());
    most += share_found(truth[i].most, estimate[i].most, sought) / static_cast<double>(truth.size());
  }
  row["least_stressed_in_" + window] = least;
  row["most_stressed_in_" + window] = most;
}

std::string seconds(std::uint64_t steps) { return std::to_string(steps / second) + "_s"; }

}  // namespace

Report tally_agreement(const Settings& settings) {
  const Experiment experiment = read_experiment({settings.robots, {}});
  const std::vector<Body> robots = random_robots(experiment, settings.bodies, least_springs);
  const Scene& scene = experiment.scene;
  std::vector<Rankings> truth;
  for (const std::uint64_t steps : windows) truth.push_back(exact_rankings(settings, scene, robots, steps));

  Report rows = Report::array();
  for (const auto& [name, method] : stress_methods({})) {
    PaperSimulator simulator(robots, 1, scene, time_step, method);
    Report row = {{"recorded", name}};
    std::uint64_t done = 0;
    for (std::size_t window = 0; window < std::size(windows); ++window) {
      simulator.run(windows[window] - done);
      done = windows[window];
      Rankings found;
      for (std::size_t i = 0; i < robots.size(); ++i) {
        simulator.state(i);  // throws if the robot has diverged
        found.push_back(ranking(simulator.stress(i), method.stress));
      }
      add_shares(truth[window], found, seconds(done), row);
    }
    rows.push_back(std::move(row));
  }

  const auto [smallest, largest] = std::minmax_element(
      robots.begin(), robots.end(), [](const Body& a, const Body& b) { return a.springs.size() < b.springs.size(); });
  return {
      {"study", "How far tallies agree with exact stress"},
      {"command", settings.command},
      {"device", make_cuda_simulator(scene, settings.stepping())->device()},
      {"robots", std::to_string(robots.size()) + " random ones of " + settings.robots},
      {"springs", std::to_string(smallest->springs.size()) + " to " + std::to_string(largest->springs.size())},
      {"scene", description(scene)},
      {"method", "paper-euler"},
      {"precision", settings.precision},
      {"dt", time_step},
      {"note",
       "Each number is the share of the " + std::to_string(sought) +
           " truly least or most stressed springs, by the exact stress of our simulator, that are among the " +
           std::to_string(sought) +
           " with the highest tallies of the paper's method in the same seconds from birth on; shares are means over "
           "the robots, ties between tallies are decided at random, and there are 256 groups. Atomic sums differ from "
           "exact stress because rounding makes two simulators drift apart: no tally can be expected to do better."},
      {"rows", std::move(rows)}};
}

}  // namespace evodevo::tools::bench
