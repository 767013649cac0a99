// evodevo body and simulate: single bodies out of a run and into a scene.
#include <chrono>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <sstream>

#include "body_json.hpp"
#include "commands/options.hpp"
#include "device.hpp"
#include "living_again.hpp"
#include "text.hpp"
#include "toml_reader.hpp"

namespace evodevo {
namespace {

namespace po = boost::program_options;

constexpr double frame_time = 0.01;  ///< between two frames of a trajectory, s

/// Writes a body's motion frame by frame: time, mass, x, y, z, vx, vy, vz in SI units.
class TrajectoryFile {
 public:
  explicit TrajectoryFile(const std::string& file) : stream_(file) {
    if (!stream_) throw UsageError("--trajectory " + file + ": cannot be written");
    stream_ << "time,mass,x,y,z,vx,vy,vz\n" << std::setprecision(9);
  }

  void add(double time, const State& state) {
    for (std::size_t i = 0; i < state.position.size(); ++i) {
      const Vec3 &p = state.position[i], &v = state.velocity[i];
      stream_ << time << ',' << i << ',' << p.x << ',' << p.y << ',' << p.z << ',' << v.x << ',' << v.y << ',' << v.z
              << '\n';
    }
  }

 private:
  std::ofstream stream_;
};

State state_as_given(const Body& body, const Experiment& experiment) {
  State state;
  for (const Mass& mass : body.masses) state.position.push_back(mass.rest);
  state.velocity.resize(body.masses.size());
  state.start_energy = total_energy(body, state, experiment.scene);
  return state;
}

Life birth(const Experiment& experiment, Simulator& simulator, const Newborn& newborn) {
  return std::move(Evaluation(experiment, simulator).birth({&newborn, 1}).front());
}

Life matured(const Experiment& experiment, Simulator& simulator, const Newborn& newborn) {
  Life life = birth(experiment, simulator, newborn);
  Evaluation(experiment, simulator).develop({&life, 1}, [](double) {});
  return life;
}

std::string short_text(double value) {
  std::ostringstream text;
  text << std::setprecision(4) << value;
  return text.str();
}

std::string vector_text(Vec3 v) {
  return "(" + short_text(v.x) + ", " + short_text(v.y) + ", " + short_text(v.z) + ")";
}

}  // namespace

int body_command(const Arguments& arguments) {
  CommandLine line{"body DIR [--individual ID] [--matured] [--plugin-path P]", {"DIR"}, {}};
  add_plugin_option(line.options);
  line.options.add_options()("individual", po::value<std::int64_t>(), "its id; default: the best")(
      "matured",
      "as it is after the development cycles of its life, in the pose that it is in then, not as it is born");
  const auto given = parse(std::move(line), arguments);
  if (!given) return 0;
  const Archive archive = Archive::read((*given)["DIR"].as<std::string>());
  const Experiment experiment = experiment_to_live_again(archive, given_plugin_path(*given));
  const ArchivedIndividual individual = chosen_individual(archive, *given);
  const auto simulator = make_simulator(experiment);
  const Life life =
      given->contains("matured")
          ? matured(experiment, *simulator, born_again(archive, experiment, individual, simulator->device()))
          : birth(experiment, *simulator, Newborn{individual.id, individual.born, &individual.genome});
  if (!life.alive()) {
    std::cerr << "individual " << individual.id << " has no body to show: " << name(life.result.status) << ", "
              << life.result.reason << '\n';
    return 1;
  }
  std::cout << body_to_json(life.living.body, life.living.state.position, experiment.world.material_names) << '\n';
  return 0;
}

int simulate_command(const Arguments& arguments) {
  CommandLine line{"simulate BODY.json EXPERIMENT.toml [options]", {"BODY.json", "EXPERIMENT.toml"}, {}};
  line.options.add_options()("duration", po::value<double>()->default_value(10), "simulated time, s")(
      "trajectory", po::value<std::string>(),
      "CSV file for the motion, a frame every 0.01 s or the nearest whole number of steps");
  add_experiment_options(line.options);
  const auto given = parse(std::move(line), arguments);
  if (!given) return 0;
  const auto body_file = (*given)["BODY.json"].as<std::string>();
  const Experiment experiment =
      read_experiment(experiment_source((*given)["EXPERIMENT.toml"].as<std::string>(), *given));
  const auto duration = (*given)["duration"].as<double>();
  if (!(duration > 0 && duration <= 1e6))
    throw UsageError("--duration " + to_text(duration) + ": expected more than 0 and at most 1e6 s");
  const Body body = read_body(body_file);
  const auto simulator = make_simulator(experiment);
  State state = state_as_given(body, experiment);
  const LongestStep longest =
      longest_step(experiment.step, body, state.position, experiment.scene, experiment.stepping.method);
  if (!longest.failure.empty())
    throw ConfigError(body_file + ": " + longest.failure + "; set a smaller simulation.dt, or \"auto\"");
  std::optional<TrajectoryFile> trajectory;
  if (given->contains("trajectory")) trajectory.emplace((*given)["trajectory"].as<std::string>());

  const Vec3 start = centre_of_mass(body, state.position);
  const double length = bounding_box(state.position).longest_side();
  Task task;
  task.body = &body;
  task.state = &state;
  const auto [dt, asked] = pace_over(duration, experiment.step, longest.dt);
  const std::uint64_t steps = std::max<std::uint64_t>(1, asked);
  const auto steps_of_frame = static_cast<std::uint64_t>(std::round(frame_time / dt));
  const std::uint64_t per_frame = trajectory ? std::max<std::uint64_t>(1, steps_of_frame) : steps;
  task.dt = dt;
  if (trajectory) trajectory->add(0, state);
  double seconds = 0;
  std::uint64_t spring_evaluations = 0;
  for (std::uint64_t done = 0; done < steps && task.status == Status::ok; done += per_frame) {
    const auto clock_start = std::chrono::steady_clock::now();
    task.steps = std::min(per_frame, steps - done);
    simulator->run({&task, 1}, {});
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - clock_start).count();
    spring_evaluations += task.spring_evaluations;
    if (trajectory && task.status == Status::ok) trajectory->add(state.time, state);
  }

  std::cout << body.masses.size() << " masses, " << body.springs.size() << " springs on " << simulator->device()
            << ", steps of " << short_text(1000 * dt) << " ms\n";
  if (task.status != Status::ok) {
    std::cout << name(task.status) << " after " << short_text(task.ended_at) << " s: " << task.reason << '\n';
    return 1;
  }
  const Vec3 moved = centre_of_mass(body, state.position) - start;
  std::cout << "after " << short_text(state.time) << " s the centre of mass has moved by " << vector_text(moved)
            << " m";
  if (length > 0)
    std::cout << ", " << short_text(norm({moved.x, moved.y, 0}) / length) << " body lengths along the ground";
  std::cout << "\nspeed: " << short_text(static_cast<double>(spring_evaluations) / seconds)
            << " spring evaluations/s\n";
  return 0;
}

}  // namespace evodevo
