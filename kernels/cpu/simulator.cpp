// Each thread simulates one body at a time.
#include "cpu/simulator.hpp"

#include "analysis/neighbours.hpp"
#include "cpu/run.hpp"
#include "threads/parallel.hpp"

namespace evodevo {
namespace {

template <class T>
class CpuSimulator final : public Simulator {
 public:
  CpuSimulator(const Scene& scene, const Stepping& stepping, int threads)
      : scene_(scene),
        stepping_(stepping),
        workers_(threads),
        neighbours_(make_cpu_neighbour_search()),
        kernels_(cpu::kernels<T>()) {}

  void run(std::span<Task> tasks, Recording recording) override {
    workers_.for_each(tasks.size(), [&](std::size_t i) {
      Task& task = tasks[i];
      if (task.status == Status::ok) cpu::run(task, scene_of(task, scene_), stepping_, kernels_, recording);
    });
  }

  NeighbourSearch& neighbours() override { return *neighbours_; }

  Workers& workers() override { return workers_; }

  std::string device() const override { return std::string("cpu, ") + kernels_.instruction_set; }

 private:
  Scene scene_;
  Stepping stepping_;
  Workers workers_;
  std::unique_ptr<NeighbourSearch> neighbours_;
  const cpu::Kernels<T>& kernels_;
};

}  // namespace

std::unique_ptr<Simulator> make_cpu_simulator(const Scene& scene, const Stepping& stepping, int threads) {
  if (stepping.precision == Precision::float64) return std::make_unique<CpuSimulator<double>>(scene, stepping, threads);
  return std::make_unique<CpuSimulator<float>>(scene, stepping, threads);
}

}  // namespace evodevo
