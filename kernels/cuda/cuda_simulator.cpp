// The simulator on a GPU: bodies in portions that its memory holds.
#include "cuda/cuda_simulator.hpp"

#include <algorithm>
#include <mutex>
#include <optional>
#include <stdexcept>

#include "cuda/device.hpp"
#include "cuda/portion.hpp"
#include "guard.hpp"
#include "parallel.hpp"

namespace evodevo {
namespace {

static_assert(cuda::guard_interval == EnergyGuard::interval);

constexpr std::size_t most_streams = 8;
// of the free memory, which other programs want to use too
constexpr double share_of_memory = 0.8;

template <class T>
class DeviceSimulator final : public CudaSimulator {
 public:
  DeviceSimulator(const Scene& scene, const Stepping& stepping, std::size_t memory)
      : scene_(scene),
        stepping_(stepping),
        largest_portion_(memory),
        device_(cuda::current_device()),
        kernels_(device_.architecture),
        streams_(most_streams) {}

  void run(std::span<Task> tasks, std::uint64_t steps, Recording recording) override {
    const std::lock_guard lock(mutex_);
    const cuda::Run run{scene_, stepping_, recording, steps, cuda::features_of(scene_, stepping_.precision, recording)};
    device_seconds_ = 0;
    std::vector<cuda::Plan<T>> plans = plan(begin(tasks, run), run);
    for (std::span<cuda::Plan<T>> left = plans; !left.empty();) {
      const std::size_t count = portion_from(left);
      cuda::Portion<T> portion(left.first(count), run, memory_);
      device_seconds_ += portion.simulate(kernels_, streams_);
      left = left.subspan(count);
    }
  }

  std::string device() const override { return "cuda, " + device_.name + ", " + device_.architecture; }

  double device_seconds() const override { return device_seconds_; }

 private:
  /// Empties the answers and gives the tasks that need the device; bodies without masses only grow older.
  static std::vector<Task*> begin(std::span<Task> tasks, const cuda::Run& run) {
    std::vector<Task*> live;
    for (Task& task : tasks) {
      if (task.status != Status::ok) continue;
      task.stress.assign(run.recording.stress ? task.body->springs.size() : 0, 0.0);
      task.work = 0;
      task.spring_evaluations = 0;
      if (run.steps == 0) continue;
      if (task.body->masses.empty())
        task.state->steps += run.steps;
      else
        live.push_back(&task);
    }
    return live;
  }

  std::vector<cuda::Plan<T>> plan(const std::vector<Task*>& tasks, const cuda::Run& run) const {
    std::vector<std::optional<cuda::Plan<T>>> planned(tasks.size());
    parallel_for(tasks.size(), 0, [&](std::size_t i) {
      planned[i].emplace(*tasks[i], scene_, stepping_, run.features, device_.shared_bytes);
    });
    std::vector<cuda::Plan<T>> plans;
    for (auto& one : planned) plans.push_back(*std::move(one));
    return plans;
  }

  /// How many of the next plans the device's memory holds together.
  std::size_t portion_from(std::span<const cuda::Plan<T>> plans) const {
    const auto free = static_cast<double>(cuda::free_memory() + memory_.size());
    const std::size_t budget = std::min(largest_portion_, static_cast<std::size_t>(share_of_memory * free));
    cuda::Sizes sizes;
    for (std::size_t count = 0; count < plans.size(); ++count) {
      sizes += plans[count].sizes();
      if (cuda::Portion<T>::bytes_for(sizes, count + 1) > budget) return std::max<std::size_t>(count, 1);
    }
    return plans.size();
  }

  Scene scene_;
  Stepping stepping_;
  std::size_t largest_portion_;  // bytes
  cuda::Device device_;
  std::mutex mutex_;
  cuda::KernelStore kernels_;
  std::vector<cuda::Stream> streams_;
  cuda::MirroredMemory memory_;
  double device_seconds_ = 0;
};

}  // namespace

std::unique_ptr<CudaSimulator> make_cuda_simulator(const Scene& scene, const Stepping& stepping, std::size_t memory) {
  if (stepping.method != Method::paper_euler)
    throw std::invalid_argument(
        "simulation.method: \"" + std::string(name(stepping.method)) +
        "\" runs on the CPU alone; set simulation.device to \"cpu\", or simulation.method to \"" +
        std::string(name(Method::paper_euler)) + "\"");
  if (stepping.precision == Precision::float64)
    return std::make_unique<DeviceSimulator<double>>(scene, stepping, memory);
  return std::make_unique<DeviceSimulator<float>>(scene, stepping, memory);
}

}  // namespace evodevo
