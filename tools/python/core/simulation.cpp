#include "simulation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/text.hpp"
#include "bodies.hpp"
#include "experiment/device.hpp"
#include "experiment/time_steps.hpp"
#include "life/birth.hpp"
#include "life/life_simulation.hpp"
#include "settings.hpp"

namespace evodevo::python {
namespace {

constexpr double longest = 1e6;  ///< simulated time, s

/// A word of Python, and what it stands for.
template <class T>
using Word = std::pair<std::string_view, T>;

/// A quantity of each spring that is recorded.
struct SpringRecord {
  bool Recording::*request;
  std::vector<double> SpringRecords::*values;
};
constexpr std::array<Word<SpringRecord>, 4> spring_records{{
    {"stress", {&Recording::stress, &SpringRecords::stress}},
    {"peak_force", {&Recording::peak_force, &SpringRecords::peak_force}},
    {"muscle_work", {&Recording::muscle_work, &SpringRecords::muscle_work}},
    {"tension", {&Recording::tension, &SpringRecords::tension}},
}};

constexpr std::array<Word<bool Channels::*>, 4> channels{{
    {"centre", &Channels::centre},
    {"positions", &Channels::positions},
    {"velocities", &Channels::velocities},
    {"forces", &Channels::forces},
}};

/// Returns what each of some words stands for. Throws ValueError that begins with `argument`.
template <class T, std::size_t count>
std::vector<Word<T>> looked_up(const std::vector<std::string>& words, const std::array<Word<T>, count>& known,
                               const std::string& argument) {
  std::vector<Word<T>> found;
  for (const std::string& word : words) {
    const auto one = std::ranges::find(known, word, &Word<T>::first);
    std::vector<std::string> names;
    for (const auto& [name, meaning] : known) names.emplace_back(name);
    if (one == known.end())
      throw py::value_error(argument + ": \"" + printable(word) + "\"; expected some of " + joined(names));
    found.push_back(*one);
  }
  return found;
}

/// What to simulate, besides the bodies.
struct Order {
  double seconds = 0;
  std::vector<Word<SpringRecord>> records;
  double sample_hz = 0;
  std::vector<Word<bool Channels::*>> channels;

  Recording recording() const {
    Recording recording;
    for (const auto& [name, record] : records) recording.*record.request = true;
    return recording;
  }
  std::vector<SampleTime> sample_times() const {
    Channels requested;
    for (const auto& [name, channel] : channels) requested.*channel = true;
    std::vector<SampleTime> times;
    if (!(sample_hz > 0)) return times;
    const auto last = static_cast<std::uint64_t>(std::floor(seconds * sample_hz * (1 + 1e-12)));
    for (std::uint64_t i = 0; i <= last; ++i) times.push_back({static_cast<double>(i) / sample_hz, requested});
    return times;
  }
};

Order order_of(double seconds, const std::vector<std::string>& record, double sample_hz,
               const std::vector<std::string>& sampled) {
  if (!(seconds > 0 && seconds <= longest))
    throw py::value_error("seconds: " + to_text(seconds) + "; expected more than 0 and at most " + to_text(longest) +
                          " s");
  if (!(sample_hz >= 0 && std::isfinite(sample_hz)))
    throw py::value_error("sample_hz: " + to_text(sample_hz) + "; expected 0 or a finite number above 0 Hz");
  return {seconds, looked_up(record, spring_records, "record"), sample_hz, looked_up(sampled, channels, "sampled")};
}

/// Bodies in the scene in which they are simulated together.
class Batch {
 public:
  Batch(Experiment experiment, std::vector<GivenBody> bodies)
      : experiment_(std::move(experiment)),
        simulator_(make_simulator(experiment_)),
        simulation_(experiment_, *simulator_, Conditions(experiment_)),
        lives_(bodies.size()) {
    const Birth birth(experiment_, simulation_);
    simulator_->workers().for_each(bodies.size(), [&](std::size_t i) {
      GivenBody& given = bodies[i];
      lives_[i] = given.state ? birth.amid_life(std::move(given.body), std::move(*given.state))
                              : birth.of(std::move(given.body));
    });
  }

  void run(const Order& order) {
    if (std::ranges::none_of(lives_, &Life::alive)) return;
    for (std::size_t i = 0; i < lives_.size(); ++i)
      if (lives_[i].alive()) check_pace(order, i);
    const std::vector<SampleTime> times = order.sample_times();
    const auto announced = simulator_->announce(lives_.size());
    simulation_.run(lives_, {.duration = order.seconds, .samples = times},
                    [&](std::span<Task> tasks, std::span<Life* const>) { simulator_->run(tasks, order.recording()); });
  }

  const std::vector<Life>& lives() const { return lives_; }
  Pace pace(const Order& order, const Life& life) const {
    return pace_of(order.seconds, experiment_.step, life.living.longest_dt);
  }

 private:
  /// Throws ConfigError if a body would make no step, or several samples would be of the same step.
  void check_pace(const Order& order, std::size_t i) const {
    const Pace pace = this->pace(order, lives_[i]);
    const std::string body = "bodies[" + std::to_string(i) + "]: ";
    if (pace.steps == 0)
      throw ConfigError(body + "seconds: " + to_text(order.seconds) +
                        " is less than half a time step; expected at least " + to_text(pace.dt) + " s");
    const double step = pace.dt * static_cast<double>(pace.refine);
    if (order.sample_hz * step > 1 + 1e-9)
      throw ConfigError(body + "sample_hz: " + to_text(order.sample_hz) +
                        " is more than one sample for each time step; expected at most " + to_text(1 / step) + " Hz");
  }

  Experiment experiment_;
  std::unique_ptr<Simulator> simulator_;
  LifeSimulation simulation_;
  std::vector<Life> lives_;
};

/// Returns a new array of a quantity in each of some samples.
template <class T, class Append>
py::array_t<T> sampled_array(const std::vector<StoredSample>& samples, Shape shape, const Append& append) {
  std::vector<T> all;
  for (const StoredSample& sample : samples) append(sample, all);
  shape.insert(shape.begin(), static_cast<py::ssize_t>(samples.size()));
  return array_of(std::span<const T>(all), std::move(shape));
}

py::dict samples_of(const Life& life, const Order& order) {
  const auto masses = static_cast<py::ssize_t>(life.living.body.masses.size()),
             springs = static_cast<py::ssize_t>(life.living.body.springs.size());
  const auto floats = [&](std::vector<float> StoredSample::*list, Shape shape) {
    return sampled_array<float>(life.samples, std::move(shape),
                                [&](const StoredSample& sample, std::vector<float>& all) {
                                  all.insert(all.end(), (sample.*list).begin(), (sample.*list).end());
                                });
  };
  py::dict samples;
  if (!(order.sample_hz > 0)) return samples;
  for (const auto& [name, channel] : order.channels) {
    const py::str key(std::string{name});
    if (channel == &Channels::centre)
      samples[key] = sampled_array<double>(life.samples, {3}, [](const StoredSample& sample, std::vector<double>& all) {
        all.insert(all.end(), {sample.centre.x, sample.centre.y, sample.centre.z});
      });
    else if (channel == &Channels::positions)
      samples[key] = floats(&StoredSample::positions, {masses, 3});
    else if (channel == &Channels::velocities)
      samples[key] = floats(&StoredSample::velocities, {masses, 3});
    else
      samples[key] = floats(&StoredSample::forces, {springs});
  }
  return samples;
}

py::array_t<double> masses_of(const Body& body) {
  std::vector<double> masses;
  for (const Mass& mass : body.masses) masses.push_back(mass.mass);
  return array_of(masses);
}

SimulationResult result_of(const Life& life, const Order& order, const Batch& batch) {
  SimulationResult result{.status = name(life.result.status), .reason = life.result.reason};
  result.ended_at = life.result.ended_at;
  result.time = life.living.state.time;
  if (life.result.status != Status::invalid) result.dt = batch.pace(order, life).dt;
  result.positions = array_of(life.living.state.position);
  result.velocities = array_of(life.living.state.velocity);
  result.masses = masses_of(life.living.body);
  if (life.alive())
    for (const auto& [name, record] : order.records)
      result.records[py::str(std::string{name})] = array_of(life.living.*record.values);
  result.sample_times = sampled_array<double>(
      life.samples, {}, [](const StoredSample& sample, std::vector<double>& all) { all.push_back(sample.time); });
  result.samples = samples_of(life, order);
  return result;
}

}  // namespace

std::vector<SimulationResult> simulate(const py::sequence& bodies, double seconds, const py::dict& scene,
                                       const py::dict& simulation, double cycle_time,
                                       const std::vector<std::string>& record, double sample_hz,
                                       const std::vector<std::string>& sampled) {
  const Order order = order_of(seconds, record, sample_hz, sampled);
  if (!(cycle_time >= shortest_cycle && cycle_time <= longest))
    throw py::value_error("cycle_time: " + to_text(cycle_time) + "; expected " + to_text(shortest_cycle) + " to " +
                          to_text(longest) + " s");
  Experiment experiment = experiment_with(scene, simulation);
  experiment.step.unit = cycle_time;
  std::vector<GivenBody> given;
  for (const py::handle body : bodies) given.push_back(body_from(body, "bodies[" + std::to_string(given.size()) + "]"));
  std::unique_ptr<Batch> batch;
  {
    const py::gil_scoped_release others_may_run_python;
    batch = std::make_unique<Batch>(std::move(experiment), std::move(given));
    batch->run(order);
  }
  std::vector<SimulationResult> results;
  for (const Life& life : batch->lives()) results.push_back(result_of(life, order, *batch));
  return results;
}

}  // namespace evodevo::python
