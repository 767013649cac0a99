// What the host does for robots that a GPU simulates.
#include <chrono>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "analysis/split_materials.hpp"
#include "base/philox.hpp"
#include "cpu/simulator.hpp"
#include "cuda/layout/features.hpp"
#include "cuda/layout/resident.hpp"
#include "cuda/layout/sampling.hpp"
#include "evolution/breeding.hpp"
#include "life/evaluation.hpp"
#include "studies.hpp"

namespace evodevo::tools::bench {
namespace {

constexpr std::size_t shared_bytes = 227 << 10;  // of a block on an H100 or H200

/// How often something was done, and how long it took in all.
struct Stage {
  std::string name;
  std::uint64_t times = 0;
  double seconds = 0;

  template <class Work>
  auto measured(const Work& work) {
    using Clock = std::chrono::steady_clock;
    struct Stopwatch {
      Stage& stage;
      Clock::time_point start = Clock::now();
      ~Stopwatch() {
        stage.seconds += std::chrono::duration<double>(Clock::now() - start).count();
        ++stage.times;
      }
    } stopwatch{*this};
    return work();
  }
};

/// The search for neighbours on the CPU, with its time. On a GPU, the device does it.
class TimedSearch final : public NeighbourSearch {
 public:
  explicit TimedSearch(NeighbourSearch& search) : search_(search) {}
  void find(std::span<const PointCloud> clouds, Workers& workers, const Use& use) override {
    Stage joining{"joining"};
    stage.measured([&] {
      search_.find(clouds, workers,
                   [&](std::size_t i, std::span<const IndexPair> pairs) { joining.measured([&] { use(i, pairs); }); });
    });
    stage.seconds -= joining.seconds;
  }

  Stage stage{"search for neighbours, which a GPU does itself"};

 private:
  NeighbourSearch& search_;
};

/// Does everything that a simulator on a GPU does on the host, with one thread: prepares bodies and reads answers. But
/// it does not move the bodies, and records random numbers.
class HostSide final : public Simulator {
 public:
  HostSide(const Scene& scene, const Stepping& stepping)
      : scene_(scene), stepping_(stepping), cpu_(make_cpu_simulator(scene, stepping, 1)), search_(cpu_->neighbours()) {}

  void run(std::span<Task> tasks, Recording recording) override {
    for (Task& task : tasks) {
      if (task.status != Status::ok) continue;
      task.clear(recording, task.body->springs.size());
      if (task.steps > 0) prepare_and_read(task, recording);
    }
  }
  NeighbourSearch& neighbours() override { return search_; }
  Workers& workers() override { return cpu_->workers(); }
  std::string device() const override { return "none"; }

  const Stage& search() const { return search_.stage; }

  Stage splitting{"splitting materials"}, begin{"bounds of energy and forces"}, arrange{"arranging a body"},
      rearrange{"arranging a changed body"}, pack{"packing"}, unpack{"unpacking"};

 private:
  void prepare_and_read(Task& task, Recording recording) {
    const Body* const given = task.body;
    task.split = splitting.measured([&] { return SplitBody::of(*given, std::move(task.split)); });
    if (task.split) task.body = &task.split->body();
    const Scene& scene = task.scene ? *task.scene : scene_;
    task.course = begin.measured([&] {
      Course course = course_of(task, scene, stepping_.precision);
      course.forces = cuda::force_range<float>(*task.body, *task.state, scene);
      return course;
    });
    const auto plan = (task.preparation ? rearrange : arrange).measured([&] {
      return cuda::Resident<float>::arrange(
          task,
          cuda::features_of(scene, stepping_, recording, cuda::material_features(*task.body),
                            cuda::channels_on_device(task)),
          {shared_bytes});
    });
    if (!plan) throw std::runtime_error("a robot does not fit on a multiprocessor; give smaller ones");
    const cuda::Sizes sizes = plan->sizes();
    memory_.resize(std::max(memory_.size(), sizes.mirrored()));
    const cuda::Regions host{memory_.data(), memory_.data() + sizes.input, memory_.data() + sizes.input + sizes.state};
    cuda::ResidentBody<float> description;
    pack.measured([&] { plan->pack(host, host, scene, &description); });
    auto* const sums = reinterpret_cast<double*>(host.sums);
    for (std::size_t i = 0; i < sizes.sums / sizeof(double); ++i) sums[i] = random_.uniform(0, 1);
    unpack.measured([&] { plan->unpack(host, recording, task); });
    task.body = given;
  }

  Scene scene_;
  Stepping stepping_;
  std::unique_ptr<Simulator> cpu_;
  TimedSearch search_;
  Rng random_{philox, {}};
  std::vector<std::byte> memory_;
};

}  // namespace

Report host_work(const Settings& settings) {
  const Experiment experiment = read_experiment({settings.robots, {{"simulation.threads", "1", ""}}});
  if (experiment.stepping.precision != Precision::float32)
    throw std::runtime_error(settings.robots + ": this study measures single precision");
  const std::vector<Individual> individuals = breed(experiment, {}, 0, 0, settings.bodies);
  std::vector<Newborn> newborns;
  for (const Individual& one : individuals) newborns.push_back({one.id, one.born, &one.genome});
  HostSide host(experiment.scene, experiment.stepping);
  const Evaluation evaluation(experiment, host);
  Stage whole{"everything"};
  whole.measured([&] {
    std::vector<Life> lives = evaluation.birth.of(newborns);
    evaluation.development.run(lives, [](double) {});
  });
  const PhaseTimes times = evaluation.phase_times();
  const double robots = static_cast<double>(newborns.size());
  Report rows = Report::array();
  const auto add = [&](const Stage& stage) {
    rows.push_back({{"stage", stage.name},
                    {"times_per_robot", static_cast<double>(stage.times) / robots},
                    {"microseconds_each", 1e6 * stage.seconds / std::max(1.0, static_cast<double>(stage.times))},
                    {"milliseconds_per_robot", 1e3 * stage.seconds / robots}});
  };
  add({"making a body from a genome", newborns.size(), times.decode - host.search().seconds});
  add({host.search().name, newborns.size(), host.search().seconds});
  for (const Stage* stage : {&host.splitting, &host.begin, &host.arrange, &host.rearrange, &host.pack, &host.unpack})
    add(*stage);
  add({"developing a body", host.pack.times, times.develop});
  add({whole.name, newborns.size(), whole.seconds});
  return {{"study", "What the host does for robots on a GPU"},
          {"command", settings.command},
          {"robots", settings.robots},
          {"number_of_robots", newborns.size()},
          {"note", "Birth and development of random robots, without the final measurement, on one thread."},
          {"rows", std::move(rows)}};
}

}  // namespace evodevo::tools::bench
