#include "overlap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "common/agreement.hpp"
#include "common/robots.hpp"
#include "experiment/device.hpp"
#include "life/evaluation.hpp"

namespace evodevo::tools::stress {
namespace {

// minimum number of springs of a robot, so that the springs sought are a small share of them
constexpr std::size_t fewest_springs = 10 * least_sought;

std::vector<double> negated(std::vector<double> values) {
  for (double& value : values) value = -value;
  return values;
}

/// The quantile of `values` at `share`, with linear interpolation.
double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const double at = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return std::lerp(values[below], values[above], at - static_cast<double>(below));
}

/// Robots that are simulated together without development, with the stress of their springs since birth.
class Robots {
 public:
  Robots(const Experiment& experiment, Simulator& simulator, std::vector<Life> born)
      : experiment_(experiment), simulator_(simulator), lives_(std::move(born)) {
    std::erase_if(lives_, [](const Life& life) { return !life.alive(); });
    tasks_.resize(lives_.size());
    sums_.resize(lives_.size());
    over_time_.resize(lives_.size());
  }

  void move_to(double time) {
    const double duration = time - now_;
    for (std::size_t i = 0; i < tasks_.size(); ++i) {
      LivingBody& living = lives_[i].living;
      const Pace pace = pace_of(duration, experiment_.step, living.longest_dt);
      tasks_[i].body = &living.body;
      tasks_[i].state = &living.state;
      tasks_[i].dt = pace.dt;
      tasks_[i].steps = pace.steps;
    }
    simulator_.run(tasks_, {.stress = true});
    now_ = time;
    for (std::size_t i = 0; i < tasks_.size(); ++i)
      if (tasks_[i].status == Status::ok) add(tasks_[i].stress, duration, i);
  }

  /// Returns the recordings of the robots that have not diverged.
  std::vector<StressOverTime> take() {
    std::vector<StressOverTime> sound;
    for (std::size_t i = 0; i < tasks_.size(); ++i)
      if (tasks_[i].status == Status::ok) sound.push_back(std::move(over_time_[i]));
    return sound;
  }

 private:
  void add(const std::vector<double>& stress, double duration, std::size_t robot) {
    std::vector<double>& sum = sums_[robot];
    sum.resize(stress.size());
    for (std::size_t s = 0; s < sum.size(); ++s) sum[s] += duration * stress[s];
    std::vector<double>& mean = over_time_[robot].emplace_back(sum);
    for (double& value : mean) value /= now_;
  }

  const Experiment& experiment_;
  Simulator& simulator_;
  std::vector<Life> lives_;
  std::vector<Task> tasks_;
  double now_ = 0;                         // time since birth [s]
  std::vector<std::vector<double>> sums_;  // time integral of |force| of each spring [N s]
  std::vector<StressOverTime> over_time_;
};

void add_row(const Case& one, double time, const char* sought, std::size_t count, const std::vector<double>& shares,
             double springs, Table& table) {
  const double mean = std::accumulate(shares.begin(), shares.end(), 0.0) / static_cast<double>(shares.size());
  table.add({one.scene, one.experiment, std::string(sought), static_cast<double>(count), time, mean,
             quantile(shares, 0.1), quantile(shares, 0.9), static_cast<double>(count) / springs,
             static_cast<double>(shares.size())});
}

/// `last` is the row of the longest cycle time of a scene and kind of springs. Returns the shortest cycle time, s, such
/// that it and all longer ones find at least `share` of the springs that the longest one finds; NaN if only the longest
/// one does.
double shortest_cycle(const Table& overlap, std::size_t last, double share) {
  double shortest = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t row = last; row-- > 0;) {
    if (overlap.text(row, "scene") != overlap.text(last, "scene")) break;
    if (overlap.text(row, "sought") != overlap.text(last, "sought")) continue;
    if (!(overlap.number(row, "found (1)") >= share)) break;
    shortest = overlap.number(row, "cycle time (s)");
  }
  return shortest;
}

}  // namespace

Found found(const std::vector<double>& truth, const std::vector<double>& estimate) {
  return {share_found(negated(truth), negated(estimate), least_sought), share_found(truth, estimate, most_sought)};
}

std::vector<Case> cases(const std::vector<std::string>& experiments) {
  std::vector<Case> all;
  for (const std::string& file : experiments) {
    const std::string name = std::filesystem::path(file).stem().string();
    for (const Case& other : all)
      if (other.scene == name)
        throw std::invalid_argument(file + ": " + other.experiment + " has the same name; rename one of them");
    all.push_back({name, file});
  }
  all.push_back({all.front().scene + ", muscles still", all.front().experiment, true});
  return all;
}

std::vector<double> cycle_times() { return {0.05, 0.1, 0.2, 0.5, 1, 2, 5, 6.5, 8, 10}; }

Experiment experiment_of(const Case& one, const std::string& device) {
  return read_experiment({one.experiment, {{"simulation.device", device, "--device"}}});
}

std::vector<StressOverTime> simulate(const Case& one, std::size_t robots, const std::string& device) {
  const Experiment experiment = experiment_of(one, device);
  const std::vector<Genome> genomes = random_genomes(experiment, robots, fewest_springs);
  std::vector<Newborn> newborns;
  for (const Genome& genome : genomes) newborns.push_back({static_cast<std::uint32_t>(newborns.size()), 0, &genome});
  const auto simulator = make_simulator(experiment);
  std::vector<Life> born = Evaluation(experiment, *simulator).birth.of(newborns);
  if (one.muscles_still)
    for (Life& life : born)
      for (Material& material : life.living.body.materials) material.amplitude = 0;
  Robots living(experiment, *simulator, std::move(born));
  for (const double time : cycle_times()) living.move_to(time);
  return living.take();
}

Table overlap_table() {
  return {"stress_overlap",
          {"scene", "experiment", "sought", "springs sought", "cycle time (s)", "found (1)",
           "found by the 10th percentile (1)", "found by the 90th percentile (1)", "by chance (1)", "robots"}};
}

void add_rows(const Case& one, const std::vector<StressOverTime>& robots, Table& table) {
  if (robots.empty())
    throw std::runtime_error("all robots of " + one.experiment + " have diverged; give another experiment");
  double springs = 0;
  for (const StressOverTime& robot : robots)
    springs += static_cast<double>(robot.back().size()) / static_cast<double>(robots.size());
  const std::vector<double> times = cycle_times();
  for (std::size_t t = 0; t < times.size(); ++t) {
    std::vector<double> least, most;
    for (const StressOverTime& robot : robots) {
      const Found shares = found(robot.back(), robot.at(t));
      least.push_back(shares.least);
      most.push_back(shares.most);
    }
    add_row(one, times[t], "least stressed", least_sought, least, springs, table);
    add_row(one, times[t], "most stressed", most_sought, most, springs, table);
  }
}

Table shortest_cycles(const Table& overlap, std::span<const double> shares) {
  Table table("stress_shortest_cycle", {"scene", "sought", "share found (1)", "shortest cycle (s)"});
  for (std::size_t row = 0; row < overlap.rows().size(); ++row) {
    if (overlap.number(row, "cycle time (s)") != cycle_times().back()) continue;
    for (const double share : shares)
      table.add({overlap.text(row, "scene"), overlap.text(row, "sought"), share, shortest_cycle(overlap, row, share)});
  }
  return table;
}

}  // namespace evodevo::tools::stress
