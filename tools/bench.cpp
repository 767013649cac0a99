// Measures how many springs the simulator evaluates in a second.
#include <hwy/targets.h>

#include <algorithm>
#include <boost/program_options.hpp>
#include <chrono>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "evodevo/body.hpp"
#include "evodevo/lattice.hpp"
#include "neighbours.hpp"
#include "parallel.hpp"
#include "scene.hpp"
#include "simulator.hpp"
#ifdef EVODEVO_CUDA
#include "cuda/cuda_simulator.hpp"
#endif

namespace {

using namespace evodevo;
using nlohmann::ordered_json;

constexpr double mass_of_each = 0.2;  // kg

/// What the command line asks for.
struct Settings {
  std::string device, body, precision, instructions;
  std::uint32_t masses = 0, bodies = 0;
  std::uint64_t steps = 0;
  int threads = 0, runs = 0;
  bool json = false;
};

/// The paper's materials but air (Table I), one after the other on the springs.
std::vector<Material> paper_materials() {
  const double half_turn = 3.14159265358979323846;
  return {{5000, 0.14, 1, 0}, {4000, 0, 0, 0}, {5000, 0.14, 1, half_turn}, {10000, 0, 0, 0}};
}

Body body_of(const std::vector<Vec3>& places, const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs) {
  Body body;
  body.materials = paper_materials();
  for (const Vec3& place : places) body.masses.push_back({place, mass_of_each});
  for (const auto& [a, b] : pairs) {
    const auto material = static_cast<std::uint32_t>(body.springs.size() % body.materials.size());
    body.springs.push_back({a, b, norm(places[b] - places[a]), material});
  }
  return body;
}

/// A lattice of 10 x 10 x 10 voxels, one metre high (paper, section V-A).
Body cube10() {
  const Lattice lattice = make_lattice({10, 10, 10}, 0.1);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const LatticeSpring& spring : lattice.springs) pairs.emplace_back(spring.a, spring.b);
  return body_of(lattice.corners, pairs);
}

/// Random points in the unit ball, each joined to its 25 nearest neighbours.
Body random_ball(std::uint32_t masses) {
  std::mt19937_64 random(1);
  const auto coordinate = [&] { return static_cast<double>(random() >> 11) * 0x1p-52 - 1; };
  std::vector<Vec3> places;
  while (places.size() < masses) {
    const double x = coordinate(), y = coordinate(), z = coordinate();
    if (dot({x, y, z}, {x, y, z}) <= 1) places.push_back({x, y, z});
  }
  return body_of(places, nearest_pairs(places, 25));
}

Body body_named(const Settings& settings) {
  if (settings.body == "cube10") return cube10();
  if (settings.body == "knn1000") return random_ball(settings.masses);
  throw std::invalid_argument("unknown body \"" + settings.body + "\": cube10 or knn1000");
}

Scene walking_scene() { return {Gravity{}, Floor{}, Friction{}, Damping{}, std::nullopt}; }

Stepping stepping_of(const Settings& settings) {
  if (settings.precision != "float32" && settings.precision != "float64")
    throw std::invalid_argument("unknown precision \"" + settings.precision + "\": float32 or float64");
  return {Method::paper_euler, settings.precision == "float32" ? Precision::float32 : Precision::float64, 0.0005};
}

/// Limits the simulator to older instruction sets, to compare them.
void limit_instructions(const std::string& name) {
  const std::map<std::string, std::int64_t> limits{
      {"best", 0}, {"avx2", HWY_AVX2 | HWY_SSE4 | HWY_SCALAR}, {"sse4", HWY_SSE4 | HWY_SCALAR}, {"none", HWY_SCALAR}};
  const auto limit = limits.find(name);
  if (limit == limits.end())
    throw std::invalid_argument("unknown instructions \"" + name + "\": best, avx2, sse4, none");
  hwy::SetSupportedTargetsForTest(limit->second);
}

std::unique_ptr<Simulator> make_simulator(const Settings& settings) {
#ifdef EVODEVO_CUDA
  if (settings.device == "cuda") return make_cuda_simulator(walking_scene(), stepping_of(settings));
#endif
  return make_cpu_simulator(walking_scene(), stepping_of(settings), settings.threads);
}

/// The time that a device took for the steps alone, s; for the CPU, which has nothing to copy, none.
std::optional<double> device_seconds([[maybe_unused]] const Simulator& simulator) {
#ifdef EVODEVO_CUDA
  if (const auto* cuda = dynamic_cast<const CudaSimulator*>(&simulator)) return cuda->device_seconds();
#endif
  return std::nullopt;
}

/// A batch of equal bodies and the time that it takes to move it.
class Batch {
 public:
  Batch(const Settings& settings, const Body& body)
      : body_(body), simulator_(make_simulator(settings)), states_(settings.bodies), steps_(settings.steps) {}

  std::string device() const { return simulator_->device(); }

  /// Spring evaluations per second of one run from birth.
  struct Rate {
    double whole;   ///< of the whole call
    double device;  ///< of the device's own time; the same on the CPU
  };
  Rate rate(Recording recording) {
    std::vector<Task> tasks(states_.size());
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      states_[i] = state_at_birth(body_, walking_scene());
      tasks[i].body = &body_;
      tasks[i].state = &states_[i];
    }
    const auto start = std::chrono::steady_clock::now();
    simulator_->run(tasks, steps_, recording);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    double evaluations = 0;
    for (const Task& task : tasks) {
      if (task.status != Status::ok) throw std::runtime_error("a body has diverged: " + task.reason);
      evaluations += static_cast<double>(task.spring_evaluations);
    }
    return {evaluations / seconds.count(), evaluations / device_seconds(*simulator_).value_or(seconds.count())};
  }

 private:
  const Body& body_;
  std::unique_ptr<Simulator> simulator_;
  std::vector<State> states_;
  std::uint64_t steps_;
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

ordered_json measure(const Settings& settings) {
  limit_instructions(settings.instructions);
  const Body body = body_named(settings);
  Batch batch(settings, body);
  // warm-up; compiles the kernels of a GPU
  batch.rate({});
  batch.rate({.stress = true});
  batch.rate({.work = true});
  std::vector<double> whole, plain, stress, work;
  // in turn, so that whatever else the machine does meets all of them
  for (int run = 0; run < settings.runs; ++run) {
    const Batch::Rate rate = batch.rate({});
    whole.push_back(rate.whole);
    plain.push_back(rate.device);
    stress.push_back(batch.rate({.stress = true}).device);
    work.push_back(batch.rate({.work = true}).device);
  }
  const int cores = std::min<int>(thread_count(settings.threads), static_cast<int>(settings.bodies));
  ordered_json result = {{"spring_evaluations_per_second", median(plain)}};
  if (settings.device == "cpu") {
    result["spring_evaluations_per_second_and_core"] = median(plain) / cores;
  } else {
    result["spring_evaluations_per_second_with_copies"] = median(whole);
  }
  result.update(ordered_json{{"rate_with_stress", median(stress) / median(plain)},
                             {"rate_with_work", median(work) / median(plain)},
                             {"device", batch.device()},
                             {"threads", cores},
                             {"body", settings.body},
                             {"masses", body.masses.size()},
                             {"springs", body.springs.size()},
                             {"materials", body.materials.size()},
                             {"bodies", settings.bodies},
                             {"steps", settings.steps},
                             {"runs", settings.runs},
                             {"scene", "gravity 9.81 m/s^2, floor 1e6 N/m, friction 0.5, damping 20.1 1/s"},
                             {"method", "paper-euler"},
                             {"precision", settings.precision},
                             {"dt", stepping_of(settings).dt}});
  return result;
}

std::optional<Settings> parse(int argc, char** argv) {
  namespace po = boost::program_options;
  Settings s;
  po::options_description options("Spring evaluations per second; one is one spring in one step. Options");
  options.add_options()("help", "this text");
  options.add_options()("device", po::value(&s.device)->default_value("cpu"), "cpu | cuda");
  options.add_options()("body", po::value(&s.body)->default_value("knn1000"), "cube10 | knn1000");
  options.add_options()("masses", po::value(&s.masses)->default_value(1000), "masses of knn1000");
  options.add_options()("bodies", po::value(&s.bodies)->default_value(8), "bodies in the batch");
  options.add_options()("steps", po::value(&s.steps)->default_value(2000), "time steps of 0.5 ms");
  options.add_options()("threads", po::value(&s.threads)->default_value(0), "threads; 0: all cores");
  options.add_options()("precision", po::value(&s.precision)->default_value("float32"), "float32 | float64");
  options.add_options()("instructions", po::value(&s.instructions)->default_value("best"),
                        "at most these: best | avx2 | sse4 | none");
  options.add_options()("runs", po::value(&s.runs)->default_value(5), "runs, of which the median counts");
  options.add_options()("json", po::bool_switch(&s.json), "print JSON");
  po::variables_map values;
  po::store(po::parse_command_line(argc, argv, options), values);
  po::notify(values);
  if (values.count("help")) {
    std::cout << options;
    return std::nullopt;
  }
  if (s.device != "cpu" && s.device != "cuda")
    throw std::invalid_argument("unknown device \"" + s.device + "\": cpu or cuda");
#ifndef EVODEVO_CUDA
  if (s.device == "cuda")
    throw std::invalid_argument("this program was built without CUDA; configure with -DEVODEVO_CUDA=ON");
#endif
  if (s.bodies < 1 || s.steps < 1 || s.runs < 1 || s.masses < 2)
    throw std::invalid_argument("bodies, steps and runs must be at least 1, masses at least 2");
  return s;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::optional<Settings> settings = parse(argc, argv);
    if (!settings) return 0;
    const ordered_json result = measure(*settings);
    if (settings->json) {
      std::cout << result.dump(2) << '\n';
    } else {
      for (const auto& [key, value] : result.items()) std::cout << key << ": " << value << '\n';
    }
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "bench: " << error.what() << '\n';
    return 2;
  }
}
