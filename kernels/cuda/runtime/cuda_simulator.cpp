// The simulator on a GPU.
//
//   tasks ─► begin: courses ─► plan: layout of each body ─► Coalescer: a batch, which may have plans of other callers
//   too ─► portions that fit ─► Portion::simulate ─► answers
#include "cuda/runtime/cuda_simulator.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <optional>
#include <string>

#include "analysis/guard.hpp"
#include "analysis/split_materials.hpp"
#include "core/simulator_group.hpp"
#include "cuda/runtime/clusters.hpp"
#include "cuda/runtime/cuda_neighbours.hpp"
#include "cuda/runtime/device.hpp"
#include "cuda/runtime/device_resources.hpp"
#include "cuda/runtime/portion.hpp"
#include "cuda/runtime/shared.hpp"
#include "threads/parallel.hpp"

namespace evodevo {
namespace {

static_assert(cuda::guard_interval == guard_interval);

// while one is simulated, others are prepared or their results read, for which each needs a thread
constexpr std::size_t most_batches_at_once = 16;
// share of the free memory that is used; other programs may need some too
constexpr double share_of_memory = 0.8;

std::uint64_t most_steps(std::span<Task* const> tasks) {
  std::uint64_t most = 0;
  for (const Task* task : tasks) most = std::max(most, task->steps);
  return most;
}

/// What the simulators on several equal GPUs have in common.
struct Common {
  Common(const cuda::Device& device, int threads)
      : kernels(cuda::KernelStore::of_architecture(device.architecture)), workers(std::make_shared<Workers>(threads)) {}

  std::shared_ptr<cuda::KernelStore> kernels;
  std::shared_ptr<Workers> workers;
};

template <class T>
class DeviceSimulator final : public CudaSimulator {
 public:
  DeviceSimulator(const Scene& scene, const Stepping& stepping, const cuda::Device& device, Common common,
                  std::size_t memory, unsigned largest_cluster)
      : scene_(scene),
        stepping_(stepping),
        largest_portion_(memory),
        device_(device),
        common_(std::move(common)),
        clusters_(device, largest_cluster),
        neighbours_(make_cuda_neighbour_search(device)) {}

  void run(std::span<Task> tasks, Recording recording) override {
    cuda::work_on(device_);
    const SplitMaterials split(tasks, workers());
    const std::vector<Task*> live = begin(tasks, recording);
    const auto presence = resources_->present.add(live.size());
    const std::size_t bodies = std::max(resources_->announced.number(), resources_->present.number());
    const cuda::Run run{scene_,
                        stepping_,
                        recording,
                        device_,
                        cuda::spans_per_range(live),
                        largest_cluster(),
                        clusters_.blocks_for(bodies, *common_.kernels),
                        cuda::divided(bodies, device_.multiprocessors)};
    std::get<cuda::DeviceResources::Batches<T>>(resources_->coalescers)
        .run(cuda::Kind(run, most_steps(live)), plan(live, run),
             [&](std::span<cuda::Plan<T>> batch) { simulate(batch, run); });
  }

  NeighbourSearch& neighbours() override { return *neighbours_; }

  Workers& workers() override { return *common_.workers; }

  int concurrency() const override {
    return static_cast<int>(std::min(most_batches_at_once, common_.workers->count()));
  }

  std::shared_ptr<const void> announce(std::size_t bodies) override { return resources_->announced.add(bodies); }

  std::string device() const override { return "cuda, " + device_.name + ", " + device_.architecture; }

  std::optional<DeviceUse> device_use() const override {
    const std::lock_guard lock(mutex_);
    return DeviceUse{.busy = resources_->busy.seconds() - busy_before_,
                     .portions = most_portions_,
                     .bodies = resources_->present.number()};
  }

  double device_seconds() const override {
    const std::lock_guard lock(mutex_);
    return device_seconds_;
  }

 private:
  /// Clears the results, and returns the tasks that need the device. Tasks without masses or steps end here; only their
  /// time advances.
  std::vector<Task*> begin(std::span<Task> tasks, Recording recording) const {
    std::vector<Task*> live;
    for (Task& task : tasks) {
      if (task.status != Status::ok) continue;
      task.clear(recording, task.body->springs.size());
      task.work = 0;
      task.spring_evaluations = 0;
      if (task.steps > 0 && !task.body->masses.empty()) {
        live.push_back(&task);
        continue;
      }
      Course course = begun(task);
      cuda::take_first_samples(task, stepping_.materials);
      cuda::take_samples_of_nothing(task, course);
      course.steps += task.steps;
      apply_course(task, course);
    }
    return live;
  }

  /// The blocks of the largest cluster. The first call loads a kernel, for which it frees memory if need be.
  unsigned largest_cluster() {
    unsigned largest = 1;
    resources_->memory.with_fewer(1, [&](std::size_t) { largest = clusters_.largest(*common_.kernels); });
    return largest;
  }

  /// Returns the course that a task continues, or a new course.
  Course begun(const Task& task) const {
    const Scene& scene = scene_of(task, scene_);
    Course course = course_of(task, scene, stepping_.precision);
    if (!task.course) course.forces = cuda::force_range<T>(*task.body, *task.state, scene);
    return course;
  }

  std::vector<cuda::Plan<T>> plan(const std::vector<Task*>& tasks, const cuda::Run& run) {
    std::vector<std::optional<cuda::Plan<T>>> planned(tasks.size());
    workers().for_each(tasks.size(), [&](std::size_t i) {
      tasks[i]->course = begun(*tasks[i]);
      cuda::take_first_samples(*tasks[i], stepping_.materials);
      planned[i].emplace(*tasks[i], run);
    });
    std::vector<cuda::Plan<T>> plans;
    for (auto& one : planned) plans.push_back(*std::move(one));
    return plans;
  }

  void simulate(std::span<cuda::Plan<T>> plans, const cuda::Run& run) {
    double seconds = 0;
    std::size_t portions = 0;
    for (std::span<cuda::Plan<T>> left = plans; !left.empty(); ++portions)
      left = left.subspan(simulate_next_portion(left, run, seconds));
    const std::lock_guard lock(mutex_);
    device_seconds_ = seconds;
    most_portions_ = std::max(most_portions_, portions);
  }

  /// Simulates as many plans, from the first one on, as fit in the device's memory together, and returns their number.
  /// Adds the time of the kernels to `seconds`.
  std::size_t simulate_next_portion(std::span<cuda::Plan<T>> plans, const cuda::Run& run, double& seconds) {
    const auto attempt = [&](std::size_t count) {
      const cuda::BatchResourcePool::Loan resources_of_batch(resources_->batches);
      cuda::Portion<T> portion(plans.first(count), run, resources_->memory);
      // runs that record springs have priority: after them, the host has work to do, while other runs use the device
      const bool urgent = run.recording.of_springs();
      const std::span<const cuda::Stream> streams = resources_of_batch->streams(urgent, portion.launches());
      seconds += portion.simulate(*common_.kernels, streams, workers(), resources_->busy);
    };
    try {
      return resources_->memory.with_fewer(plans_that_fit(plans), attempt);
    } catch (const cuda::OutOfMemory& error) {
      throw DeviceOutOfMemory(why_not_even_one(plans.front(), error));
    }
  }

  /// The number of plans, from the first one on, that should fit in the free memory; at least one.
  std::size_t plans_that_fit(std::span<const cuda::Plan<T>> plans) {
    const auto free = static_cast<double>(resources_->memory.available());
    const std::size_t budget = std::min(largest_portion_, static_cast<std::size_t>(share_of_memory * free));
    cuda::Sizes sizes;
    std::size_t count = 0;
    for (; count < plans.size(); ++count) {
      sizes += plans[count].sizes();
      if (sizes.on_device() > budget || sizes.on_host() > largest_portion_) break;
    }
    return std::max<std::size_t>(count, 1);
  }

  std::string why_not_even_one(const cuda::Plan<T>& plan, const cuda::OutOfMemory& error) const {
    return "CUDA: a body of " + std::to_string(plan.task->body->masses.size()) + " masses and " +
           std::to_string(plan.task->body->springs.size()) + " springs needs " +
           cuda::in_mebibytes(plan.sizes().on_device()) + " of the GPU's memory, and " +
           cuda::in_mebibytes(resources_->memory.available()) + " are free: " + error.what();
  }

  Scene scene_;
  Stepping stepping_;
  std::size_t largest_portion_;  // bytes
  cuda::Device device_;
  Common common_;
  cuda::Clusters clusters_;
  std::shared_ptr<cuda::DeviceResources> resources_ = cuda::DeviceResources::of(device_);
  std::unique_ptr<NeighbourSearch> neighbours_;
  const double busy_before_ = resources_->busy.seconds();  // this simulator was created
  mutable std::mutex mutex_;
  double device_seconds_ = 0;
  std::size_t most_portions_ = 1;
};

std::unique_ptr<CudaSimulator> make_on(const cuda::Device& device, const Scene& scene, const Stepping& stepping,
                                       const Common& common, std::size_t memory,
                                       unsigned largest_cluster = default_cluster) {
  cuda::work_on(device);
  if (stepping.precision == Precision::float64)
    return std::make_unique<DeviceSimulator<double>>(scene, stepping, device, common, memory, largest_cluster);
  return std::make_unique<DeviceSimulator<float>>(scene, stepping, device, common, memory, largest_cluster);
}

}  // namespace

std::unique_ptr<CudaSimulator> make_cuda_simulator(const Scene& scene, const Stepping& stepping, int threads,
                                                   std::size_t memory, unsigned largest_cluster) {
  const cuda::Device device = cuda::current_device();
  return make_on(device, scene, stepping, Common(device, threads), memory, largest_cluster);
}

std::unique_ptr<Simulator> make_cuda_group(const Scene& scene, const Stepping& stepping, int threads,
                                           std::span<const int> numbers) {
  const std::vector<cuda::Device> devices = cuda::usable_devices(numbers);
  const Common common(devices.front(), threads);
  std::vector<std::unique_ptr<Simulator>> members;
  std::vector<int> chosen;
  for (const cuda::Device& device : devices) {
    members.push_back(make_on(device, scene, stepping, common, default_portion));
    chosen.push_back(device.number);
  }
  if (members.size() == 1) return std::move(members.front());
  static cuda::Shared<std::vector<int>, Backlog> backlogs;  // one for all runs of this process
  return make_simulator_group(std::move(members),
                              backlogs.get(chosen, [&] { return std::make_shared<Backlog>(chosen.size()); }));
}

}  // namespace evodevo
