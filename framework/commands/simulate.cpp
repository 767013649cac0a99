// evodevo simulate: simulates a body from a file in the scene of an experiment.
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <iostream>

#include "base/output_file.hpp"
#include "base/text.hpp"
#include "commands/commands.hpp"
#include "commands/shell/options.hpp"
#include "commands/shell/output/notices.hpp"
#include "core/piecewise.hpp"
#include "experiment/toml_reader.hpp"
#include "life/body_json.hpp"
#include "life/evaluation.hpp"

namespace evodevo {
namespace {

constexpr double frame_time = 0.01;  ///< time between two frames of a trajectory, s

/// Writes a body's motion as CSV, frame by frame: time, mass, x, y, z, vx, vy, vz in SI units. Numbers have enough
/// digits to read back as the same bits.
class TrajectoryFile {
 public:
  explicit TrajectoryFile(const std::string& file) : output_(file, "--trajectory " + file) {
    output_.write("time,mass,x,y,z,vx,vy,vz\n");
  }

  void add(const State& state) {
    std::string rows;
    for (std::size_t i = 0; i < state.position.size(); ++i) {
      const Vec3 &p = state.position[i], &v = state.velocity[i];
      rows += digits(state.time) + ',' + std::to_string(i);
      for (const double number : {p.x, p.y, p.z, v.x, v.y, v.z}) rows += ',' + digits(number);
      rows += '\n';
    }
    output_.write(rows);
  }

  void finish() { output_.finish(); }

 private:
  static std::string digits(double number) {
    std::array<char, 32> buffer;
    return {buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), number).ptr};
  }

  OutputFile output_;
};

/// The cost of a simulation.
struct Motion {
  std::uint64_t spring_evaluations = 0;
  double seconds = 0;  ///< wall-clock time, s
};

/// Continues a life for `duration` (s): in one run of the simulator or, if there is a trajectory to write, frame by
/// frame.
Motion go_on(const Evaluation& evaluation, Simulator& simulator, Life& life, double duration,
             std::uint64_t steps_of_frame, TrajectoryFile* trajectory) {
  const auto start = std::chrono::steady_clock::now();
  const auto next_steps = [&](std::size_t) { return steps_of_frame; };
  const auto look = [&](std::size_t, const Task& piece) {
    if (piece.status == Status::ok) trajectory->add(*piece.state);
  };
  evaluation.simulation.run({&life, 1}, {.duration = duration}, [&](std::span<Task> tasks, std::span<Life* const>) {
    if (trajectory == nullptr) return simulator.run(tasks, {});
    trajectory->add(*tasks.front().state);
    run_in_pieces(simulator, tasks, {}, next_steps, look);
  });
  return {life.result.spring_evaluations,
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()};
}

std::string vector_text(Vec3 v) {
  return "(" + short_number(v.x) + ", " + short_number(v.y) + ", " + short_number(v.z) + ")";
}

/// Puts a life into the first repeat of a scenario.
void enter_scenario(std::size_t scenario, const Experiment& experiment, const Evaluation& evaluation, Life& life) {
  start_scenario({scenario}, experiment, evaluation.simulation, life);
  if (!life.alive())
    throw ConfigError("--scenario " + experiment.scenarios[scenario].name + ": " + name(life.result.status) + ": " +
                      life.result.reason + "; change the scenario or simulation.dt");
}

/// Returns the life of the body in a file. Throws ConfigError if the body cannot be simulated in the scene or with the
/// time step.
Life life_of(const std::string& file, const Experiment& experiment, const Evaluation& evaluation) {
  GivenBody given = read_body(file);
  Life life = given.state ? evaluation.birth.amid_life(std::move(given.body), std::move(*given.state))
                          : evaluation.birth.of(std::move(given.body));
  life.living.numbers = MassNumbers(std::move(given.identities));
  if (life.alive()) return life;
  const bool is_step = life.result.reason.starts_with("unstable dt");
  throw ConfigError(
      file + ": " + name(life.result.status) + ": " + life.result.reason +
      (is_step && !experiment.step.dt ? "; make its springs softer, or its masses heavier"
       : is_step
           ? "; set a smaller simulation.dt, or \"auto\""
           : "; leave out \"time\", \"start_energy\" and the velocities, so that the body is born on the ground"));
}

void print_end(const Life& life, double duration, Vec3 start, double length) {
  const State& state = life.living.state;
  const Vec3 moved = centre_of_mass(life.living.body, state.position) - start;
  std::cout << "after " << short_number(duration) << " s the centre of mass has moved by " << vector_text(moved)
            << " m";
  if (length > 0)
    std::cout << ", " << short_number(norm({moved.x, moved.y, 0}) / length) << " body lengths along the ground";
  std::cout << '\n';
}

int simulate(const Given& given) {
  const auto body_file = given["BODY.json"].as<std::string>(),
             experiment_file = given["EXPERIMENT.toml"].as<std::string>();
  ExperimentSource source = experiment_source(experiment_file, given);
  source.grows_bodies = false;
  const Experiment experiment = timed("reading " + printable(experiment_file), [&] { return read_experiment(source); });
  const auto duration = given["duration"].as<double>();
  if (!(duration > 0 && duration <= 1e6))
    throw UsageError("--duration " + to_text(duration) + ": expected more than 0 and at most 1e6 s");
  const auto simulator = opened_simulator(experiment);
  const Evaluation evaluation(experiment, *simulator);
  Life life = life_of(body_file, experiment, evaluation);
  if (const auto scenario = given_scenario(experiment, given)) enter_scenario(*scenario, experiment, evaluation, life);
  const Pace pace = pace_of(duration, experiment.step, life.living.longest_dt);
  if (pace.steps == 0)
    throw UsageError("--duration " + to_text(duration) + ": is less than half a time step; expected at least " +
                     to_text(pace.dt) + " s");
  std::optional<TrajectoryFile> trajectory;
  if (given.contains("trajectory")) {
    const auto file = given["trajectory"].as<std::string>();
    refuse_to_overwrite("--trajectory", file, {body_file, experiment_file});
    refuse_to_overwrite("--trajectory", file, libraries_of(experiment));
    trajectory.emplace(file);
  }

  const Vec3 start = centre_of_mass(life.living.body, life.living.state.position);
  const double length = bounding_box(life.living.state.position).longest_side();
  const double begin = life.living.state.time;
  const auto steps_of_frame = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::round(frame_time / pace.dt)));
  const Motion motion = timed("simulating " + to_text(duration) + " s", [&] {
    return go_on(evaluation, *simulator, life, duration, steps_of_frame, trajectory ? &*trajectory : nullptr);
  });
  if (trajectory) trajectory->finish();

  const Body& body = life.living.body;
  std::cout << body.masses.size() << " masses, " << body.springs.size() << " springs on " << simulator->device()
            << ", steps of " << short_number(1000 * pace.dt) << " ms\n";
  if (!life.alive()) {
    std::cout << name(life.result.status) << " after " << short_number(life.result.ended_at)
              << " s: " << life.result.reason << '\n';
    return 1;
  }
  print_end(life, life.living.state.time - begin, start, length);
  remarks() << "speed: " << short_number(static_cast<double>(motion.spring_evaluations) / motion.seconds)
            << " spring evaluations/s\n";
  return 0;
}

}  // namespace

Command simulate_command() {
  Options options;
  options.add_options()("duration", value<double>("S")->default_value(10), "simulated time, s")(
      "trajectory", value<std::string>("FILE"),
      "CSV file for the motion, with a frame every 0.01 s or the nearest whole number of time steps");
  add_scenario_option(options, "simulate the body in this scenario of the experiment instead of its scene");
  add_experiment_options(options);
  return {
      .name = "simulate",
      .arguments = {{"BODY.json"}, {"EXPERIMENT.toml"}},
      .summary = "Simulate one body in the scene of an experiment",
      .text = {"The body is one that `body` has printed, or your own. A body without \"time\" is born on the ground of "
               "the scene; a body with it continues from the positions and velocities in the file."},
      .examples = {"simulate newborn.json experiments/quickstart.toml --trajectory fall.csv"},
      .options = options,
      .function = simulate};
}

}  // namespace evodevo
