#include "paper/paper_simulator.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "cuda/layout/answers.hpp"
#include "cuda/layout/features.hpp"
#include "cuda/runtime/device.hpp"
#include "cuda/runtime/launch.hpp"
#include "paper/sources.hpp"

namespace evodevo::tools::bench {
namespace {

constexpr unsigned table_steps = 100;  // steps for which one launch fills in the table

std::size_t shared_bytes_of(const PaperLayout& layout) { return 6 * sizeof(float) * layout.most_masses; }

}  // namespace

std::vector<std::string> definitions(const PaperMethod& method, const Scene& scene) {
  const cuda::Features features = cuda::features_of(scene, {.method = Method::paper_euler}, {}, {.actuation = true});
  std::vector<std::string> all = cuda::definitions(features);
  all.push_back("EVODEVO_THREADS=" + std::to_string(method.threads));
  all.push_back("EVODEVO_STRESS_METHOD=" + std::to_string(static_cast<int>(method.stress)));
  return all;
}

PaperSimulator::PaperSimulator(std::span<const Body> bodies, std::uint32_t copies, const Scene& scene, double dt,
                               const PaperMethod& method)
    : bodies_(bodies),
      copies_(copies),
      method_(method),
      layout_(bodies, copies, scene, method.order),
      constants_(cuda::step_constants<float>(scene, dt)),
      kernels_(cuda::current_device().architecture, paper_sources()),
      body_table_(layout_.bodies),
      springs_(layout_.springs),
      mass_(layout_.mass),
      inverse_mass_(layout_.inverse_mass),
      positions_(layout_.positions),
      velocities_(layout_.positions.size()),
      forces_(layout_.positions.size()),
      actuators_(layout_.actuators),
      table_(table_steps * layout_.actuators.size()),
      stress_(layout_.springs.size()),
      least_(layout_.springs.size()),
      most_(layout_.springs.size()),
      batch_{body_table_.data(),   springs_.data(),   mass_.data(),
             inverse_mass_.data(), positions_.data(), velocities_.data(),
             forces_.data(),       table_.data(),     stress_.data(),
             least_.data(),        most_.data(),      static_cast<std::uint32_t>(layout_.actuators.size())} {
  load_kernels(scene);
}

void PaperSimulator::load_kernels(const Scene& scene) {
  const bool shared = method_.memory == MassMemory::shared;
  const auto kernel = [&](const char* name) {
    return kernels_.get(shared ? "paper/shared_memory.cu" : "paper/global_memory.cu", name,
                        definitions(method_, scene));
  };
  fill_table_ = kernel("evodevo_paper_table");
  if (!shared) {
    add_forces_ = kernel("evodevo_paper_springs");
    move_masses_ = kernel("evodevo_paper_masses");
    return;
  }
  step_ = kernel("evodevo_paper_step");
  const std::size_t needed = shared_bytes_of(layout_), available = cuda::current_device().shared_bytes;
  if (needed > available)
    throw std::runtime_error("the paper's method keeps a body's masses in shared memory: " +
                             std::to_string(layout_.most_masses) + " masses need " + std::to_string(needed) + " of " +
                             std::to_string(available) + " bytes; choose a smaller body");
  cuda::check(cudaFuncSetAttribute(reinterpret_cast<const void*>(step_), cudaFuncAttributeMaxDynamicSharedMemorySize,
                                   static_cast<int>(needed)),
              "asking for " + std::to_string(needed) + " bytes of shared memory");
  // prefers shared memory to cache, so that as many blocks as possible are resident
  cuda::check(cudaFuncSetAttribute(reinterpret_cast<const void*>(step_), cudaFuncAttributePreferredSharedMemoryCarveout,
                                   cudaSharedmemCarveoutMaxShared),
              "asking for shared memory");
}

void PaperSimulator::restart() {
  positions_.upload(layout_.positions);
  velocities_.clear();
  forces_.clear();
  stress_.clear();
  least_.clear();
  most_.clear();
  steps_ = 0;
}

double PaperSimulator::run(std::uint64_t steps) {
  const cuda::Event begin, end;
  // earlier copies and clears run in another stream
  cuda::check(cudaDeviceSynchronize(), "waiting for the GPU");
  cuda::check(cudaEventRecord(begin, stream_), "recording an event");
  for (const std::uint64_t last = steps_ + steps; steps_ < last;) {
    const auto count = static_cast<unsigned>(std::min<std::uint64_t>(last - steps_, table_steps));
    launch_table(count);
    for (unsigned row = 0; row < count; ++row) launch_step(row);
  }
  cuda::check(cudaEventRecord(end, stream_), "recording an event");
  cuda::check(cudaStreamSynchronize(stream_), "simulating on the GPU");
  float milliseconds = 0;
  cuda::check(cudaEventElapsedTime(&milliseconds, begin, end), "reading a time");
  return milliseconds / 1000.0;
}

void PaperSimulator::launch_table(unsigned count) {
  cuda::launch(fill_table_, dim3(1), 1024, 0, stream_, constants_,
               static_cast<const cuda::Actuator*>(actuators_.data()), batch_.entries, steps_, count, table_.data());
}

void PaperSimulator::launch_step(unsigned row) {
  const auto bodies = static_cast<unsigned>(layout_.bodies.size());
  const unsigned threads = method_.threads;
  const auto over = [&](std::uint32_t count) { return dim3((count + threads - 1) / threads, bodies); };
  ++steps_;
  if (method_.memory == MassMemory::global) {
    cuda::launch(add_forces_, over(layout_.most_springs), threads, 0, stream_, batch_, row);
    cuda::launch(move_masses_, over(layout_.most_masses), threads, 0, stream_, constants_, batch_);
    return;
  }
  const bool tallies = method_.stress == StressMethod::skip_shift && steps_ % method_.skip == 0;
  cuda::launch(step_, dim3(bodies), threads, shared_bytes_of(layout_), stream_, constants_, batch_, row,
               tallies ? static_cast<unsigned>(steps_ / method_.skip) : 0u);
}

State PaperSimulator::state(std::size_t body) const {
  const PaperBody& at = layout_.bodies[body * copies_];
  const std::vector<cuda::Point<float>> positions = positions_.download(), velocities = velocities_.download();
  State state;
  state.time = static_cast<double>(steps_) * constants_.exact_dt;
  for (std::uint32_t i = at.first_mass; i < at.first_mass + at.masses; ++i) {
    const auto &p = positions[i], &v = velocities[i];
    if (!std::isfinite(p.x + p.y + p.z + v.x + v.y + v.z))
      throw std::runtime_error("body " + std::to_string(body) + " has diverged in the paper's method");
    state.position.push_back({p.x, p.y, p.z});
    state.velocity.push_back({v.x, v.y, v.z});
  }
  return state;
}

RecordedStress PaperSimulator::stress(std::size_t body) const {
  const std::uint32_t first = layout_.bodies[body * copies_].first_spring;
  const std::vector<float> sums = stress_.download();
  const std::vector<std::uint32_t> least = least_.download(), most = most_.download();
  const std::vector<std::uint32_t> order = ordered_springs(bodies_[body], method_.order);
  RecordedStress recorded{std::vector<double>(order.size()), std::vector<std::uint32_t>(order.size()),
                          std::vector<std::uint32_t>(order.size())};
  for (std::uint32_t at = 0; at < order.size(); ++at) {
    recorded.sum[order[at]] = sums[first + at];
    recorded.least[order[at]] = least[first + at];
    recorded.most[order[at]] = most[first + at];
  }
  return recorded;
}

}  // namespace evodevo::tools::bench
