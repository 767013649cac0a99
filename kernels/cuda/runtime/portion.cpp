#include "cuda/runtime/portion.hpp"

#include <algorithm>
#include <functional>
#include <set>

#include "cuda/runtime/launch.hpp"

namespace evodevo::cuda {
namespace {

template <class T>
Sizes sizes_of(std::span<const Plan<T>> plans) {
  Sizes sizes;
  for (const Plan<T>& plan : plans) sizes += plan.sizes();
  return sizes;
}

/// Records an event in each stream.
std::deque<Event> ends_of(std::span<const Stream> streams) {
  std::deque<Event> ends;
  for (const Stream& stream : streams) check(cudaEventRecord(ends.emplace_back(true), stream), "recording an event");
  return ends;
}

/// Waits until all streams have come to `ends`, and returns the time from `begin` to the last, s. The thread sleeps
/// while it waits, because other batches need the core. The host waits, not a stream on the device, because launches of
/// other batches could be queued behind a waiting stream.
double wait_for(const std::deque<Event>& ends, const Event& begin) {
  float longest = 0;
  for (const Event& end : ends) {
    float milliseconds = 0;
    check(cudaEventSynchronize(end), "simulating on the GPU");
    check(cudaEventElapsedTime(&milliseconds, begin, end), "reading a time");
    longest = std::max(longest, milliseconds);
  }
  return longest / 1000.0;
}

}  // namespace

template <class T>
Plan<T>::Plan(Task& task_, const Run& run)
    : task(&task_), scene(&scene_of(task_, run.scene)), body([&]() -> decltype(body) {
        const Features features =
            features_of(*scene, run.stepping, run.recording, material_features(*task_.body), channels_on_device(task_));
        if (is_explicit(run.stepping.method))
          if (auto resident = Resident<T>::arrange(
                  task_, features, {run.device.shared_bytes, run.largest_cluster, run.wanted_blocks, run.at_once},
                  run.spans_per_range))
            return *std::move(resident);
        return Streamed<T>(task_, features, Resident<T>::largest_chip(run.device.shared_bytes), run.spans_per_range);
      }()) {}

template <class T>
Sizes Plan<T>::sizes() const {
  return std::visit([](const auto& b) { return b.sizes(); }, body);
}

template <class T>
const SampleLayout& Plan<T>::samples() const {
  return std::visit([](const auto& b) -> const SampleLayout& { return b.samples(); }, body);
}

template <class T>
std::uint64_t Plan<T>::ranges() const {
  return samples().empty() ? 1 : samples().ranges();
}

template <class T>
Portion<T>::Portion(std::span<Plan<T>> plans, const Run& run, MemoryStore& store)
    : plans_(plans),
      run_(run),
      sizes_(sizes_of<T>(plans)),
      memory_(store, sizes_.mirrored(), sizes_.scratch, sizes_.samples) {
  for (std::size_t i = 0; i < plans.size(); ++i) {
    if (const auto* resident = std::get_if<Resident<T>>(&plans[i].body)) {
      resident_[{resident->features(), resident->form(), resident->threads(), resident->blocks()}].push_back(i);
    } else {
      const auto& streamed = std::get<Streamed<T>>(plans[i].body);
      streamed_[{streamed.features(), streamed.threads()}].push_back(i);
    }
  }
  for (auto& [launch, members] : resident_)
    std::stable_sort(members.begin(), members.end(), [&](std::size_t a, std::size_t b) {
      return std::get<Resident<T>>(plans[a].body).slots() > std::get<Resident<T>>(plans[b].body).slots();
    });
  // the order in memory: descriptions, inputs, states, sums, scratch
  const auto regions = [&](std::byte* base) {
    std::byte* input = base + sizes_.descriptions;
    return Regions{input, input + sizes_.input, input + sizes_.input + sizes_.state};
  };
  Regions host = regions(memory_->host()), device = regions(memory_->device());
  device.scratch = memory_->device() + sizes_.mirrored();
  host.samples = device.samples = memory_->host() + sizes_.mirrored();
  for (const Plan<T>& plan : plans) {
    host_.push_back(host);
    device_.push_back(device);
    host = host.behind(plan.sizes());
    device = device.behind(plan.sizes());
  }
}

template <class T>
void Portion<T>::pack(Workers& workers) {
  // the order of descriptions: resident bodies by launch, then streamed bodies by launch
  std::vector<std::pair<std::size_t, ResidentBody<T>*>> resident;  // plans and their descriptions
  std::vector<std::pair<std::size_t, StreamedBody<T>*>> streamed;
  auto* to_resident = reinterpret_cast<ResidentBody<T>*>(memory_->host());
  for (const auto& [launch, members] : resident_)
    for (const std::size_t i : members) {
      resident.emplace_back(i, to_resident);
      to_resident += launch.blocks;
    }
  auto* to_streamed = const_cast<StreamedBody<T>*>(streamed_bodies(memory_->host()));
  for (const auto& [launch, members] : streamed_)
    for (const std::size_t i : members) streamed.emplace_back(i, to_streamed++);
  workers.for_each(resident.size(), [&](std::size_t k) {
    const auto& [i, to] = resident[k];
    std::get<Resident<T>>(plans_[i].body).pack(host_[i], device_[i], *plans_[i].scene, to);
  });
  workers.for_each(streamed.size(), [&](std::size_t k) {
    const auto& [i, to] = streamed[k];
    *to = std::get<Streamed<T>>(plans_[i].body).pack(host_[i], device_[i], *plans_[i].scene);
  });
}

/// The descriptions of streamed bodies, which follow those of all blocks of resident bodies.
template <class T>
const StreamedBody<T>* Portion<T>::streamed_bodies(const std::byte* descriptions) const {
  std::size_t blocks = 0;
  for (const auto& [launch, members] : resident_) blocks += launch.blocks * members.size();
  return reinterpret_cast<const StreamedBody<T>*>(descriptions + blocks * sizeof(ResidentBody<T>));
}

template <class T>
void Portion<T>::upload(cudaStream_t stream) {
  check(cudaMemcpyAsync(memory_->device(), memory_->host(), sizes_.descriptions + sizes_.input + sizes_.state,
                        cudaMemcpyHostToDevice, stream),
        "copying bodies to the GPU");
  check(cudaMemsetAsync(device_.front().sums, 0, sizes_.sums, stream), "clearing the GPU's memory");
}

template <class T>
std::vector<typename Portion<T>::ReadyLaunch> Portion<T>::ready_launches(KernelStore& kernels, Workers& workers) const {
  const auto* bodies = reinterpret_cast<const ResidentBody<T>*>(memory_->device());
  std::vector<ReadyLaunch> launches;
  for (const auto& [launch, members] : resident_) {
    launches.push_back({launch, nullptr, members, bodies});
    bodies += launch.blocks * members.size();
  }
  // kernels that are not yet compiled are compiled on all cores
  workers.for_each(launches.size(), [&](std::size_t i) {
    work_on(run_.device);
    const Launch& launch = launches[i].launch;
    launches[i].kernel =
        kernels.get("cuda/device/resident.cu", "evodevo_run_resident", definitions(launch.features, launch.form));
  });
  // the largest blocks first, so that small ones fill the gaps at the end
  const auto largest = [&](const ReadyLaunch& one) {
    return std::get<Resident<T>>(plans_[one.members.front()].body).slots() / one.launch.blocks;
  };
  std::ranges::sort(launches, std::greater(), largest);
  return launches;
}

template <class T>
std::uint64_t Portion<T>::ranges() const {
  std::uint64_t most = 1;
  for (const Plan<T>& plan : plans_) most = std::max(most, plan.ranges());
  return most;
}

/// Whether any of these bodies moves in a range.
template <class T>
bool Portion<T>::has_range(std::span<const std::size_t> members, std::uint64_t range) const {
  return std::any_of(members.begin(), members.end(), [&](std::size_t i) { return range < plans_[i].ranges(); });
}

/// Launches the steps of all bodies in a range.
template <class T>
void Portion<T>::launch_range(KernelStore& kernels, std::span<const ReadyLaunch> resident,
                              std::span<const Stream> streams, std::uint64_t range) {
  launch_resident(resident, streams, range);
  launch_streamed(kernels, streams, range);
}

template <class T>
void Portion<T>::launch_resident(std::span<const ReadyLaunch> launches, std::span<const Stream> streams,
                                 std::uint64_t range) {
  const Event ready;
  check(cudaEventRecord(ready, streams[0]), "recording an event");
  std::size_t next = 0;
  for (const ReadyLaunch& one : launches) {
    const cudaStream_t stream = streams[next++ % streams.size()];  // that of the earlier ranges
    if (!has_range(one.members, range)) continue;
    std::size_t shared_bytes = 0;
    for (const std::size_t i : one.members)
      shared_bytes = std::max(shared_bytes, std::get<Resident<T>>(plans_[i].body).chip_bytes());
    const bool in_clusters = one.launch.form.clustered;
    allow(one.kernel, Resident<T>::largest_chip(run_.device.shared_bytes, in_clusters), in_clusters);
    if (range == 0) check(cudaStreamWaitEvent(stream, ready), "waiting for an event");
    const unsigned blocks = one.launch.blocks;
    launch_clusters(one.kernel, blocks, blocks * static_cast<unsigned>(one.members.size()), one.launch.threads,
                    shared_bytes, stream, one.bodies, range);
  }
}

template <class T>
void Portion<T>::launch_streamed(KernelStore& kernels, std::span<const Stream> streams, std::uint64_t range) {
  const Event ready;
  check(cudaEventRecord(ready, streams[0]), "recording an event");
  const StreamedBody<T>* bodies = streamed_bodies(memory_->device());
  std::size_t next = 0;
  for (const auto& [launch, members] : streamed_) {
    const cudaStream_t stream = streams[next++ % streams.size()];
    if (range == 0) check(cudaStreamWaitEvent(stream, ready), "waiting for an event");
    if (has_range(members, range)) launch_streamed(kernels, stream, members, bodies, range);
    bodies += members.size();
  }
}

template <class T>
void Portion<T>::launch_streamed(KernelStore& kernels, cudaStream_t stream, std::span<const std::size_t> members,
                                 const StreamedBody<T>* bodies, std::uint64_t range) {
  const MethodForm& method = form_of(run_.stepping.method);
  const bool by_block = !is_explicit(run_.stepping.method);
  unsigned masses = 1;
  std::uint64_t check_spans = 0;
  std::size_t shared_bytes = 0;
  std::set<std::pair<std::uint64_t, unsigned>> samples;  // spans, and steps of the span
  for (const std::size_t i : members) {
    const auto& body = std::get<Streamed<T>>(plans_[i].body);
    if (!by_block)
      body.samples().for_each_in(range, [&](std::uint64_t span, unsigned step) { samples.emplace(span, step); });
    masses = std::max(masses, body.masses());
    check_spans = std::max(check_spans, body.check_spans());
    shared_bytes = std::max(shared_bytes, body.chip_bytes());
  }
  const auto& first = std::get<Streamed<T>>(plans_[members.front()].body);
  const unsigned threads = first.threads();
  const auto kernel = [&](const char* name) {
    return kernels.get(by_block ? method.file : "cuda/device/streamed/streamed.cu", name,
                       definitions(first.features()));
  };
  const cudaKernel_t fill = kernel("evodevo_fill_tables"), check_bodies = kernel("evodevo_check_streamed"),
                     move = kernel(by_block ? "evodevo_advance_streamed" : "evodevo_pass_streamed");
  if (by_block) allow(move, Resident<T>::largest_chip(run_.device.shared_bytes), false);
  cudaKernel_t sample = nullptr;
  if (!samples.empty())
    sample = kernels.get("cuda/device/streamed/sample_streamed.cu", "evodevo_sample_streamed",
                         definitions(first.features()));
  const auto count = static_cast<unsigned>(members.size());
  const dim3 over_masses((masses + threads - 1) / threads, count);
  const auto sample_after = [&](std::uint64_t span, unsigned step) {
    if (samples.contains({span, step})) launch(sample, dim3(count), check_threads, 0, stream, bodies, span, step);
  };
  const bool whole = first.samples().empty();  // none of these bodies is sampled, or all are
  const std::uint64_t begin = range * run_.spans_per_range,
                      end = whole ? check_spans : std::min(begin + run_.spans_per_range, check_spans);
  for (std::uint64_t span = begin; span < end; ++span) {
    unsigned steps = 0;
    for (const std::size_t i : members)
      steps = std::max(steps, std::get<Streamed<T>>(plans_[i].body).steps_of_span(span));
    launch(fill, dim3(count), 256, 0, stream, bodies, span, method.rows(steps));
    if (by_block) launch(move, dim3(count), threads, shared_bytes, stream, bodies, span);
    for (unsigned pass = 0; pass < method.passes(steps); ++pass) {
      launch(move, over_masses, threads, 0, stream, bodies, span, pass);
      if ((pass + 1) % method.passes_per_step == 0) sample_after(span, (pass + 1) / method.passes_per_step);
    }
    launch(fill, dim3(count), 256, 0, stream, bodies, span + 1, 1u);
    sample_after(span, 0);
    launch(check_bodies, dim3(count), check_threads, 0, stream, bodies, span);
  }
}

template <class T>
void Portion<T>::unpack_samples(Workers& workers, std::uint64_t range) {
  workers.for_each(plans_.size(), [&](std::size_t i) {
    Plan<T>& plan = plans_[i];
    if (!plan.samples().empty())
      std::visit([&](const auto& body) { body.unpack_samples(range, host_[i], *plan.task); }, plan.body);
  });
}

template <class T>
void Portion<T>::download(cudaStream_t stream) {
  check(cudaMemcpyAsync(host_.front().state, device_.front().state, sizes_.state + sizes_.sums, cudaMemcpyDeviceToHost,
                        stream),
        "copying bodies from the GPU");
  wait_for(stream, "copying bodies from the GPU");
}

template <class T>
double Portion<T>::simulate(KernelStore& kernels, std::span<const Stream> streams, Workers& workers, BusyClock& busy) {
  const Event begin;
  double seconds = 0;
  pack(workers);
  {
    const BusyClock::Span span(busy);
    const StreamsAtRest at_rest(streams);
    upload(streams[0]);
    check(cudaEventRecord(begin, streams[0]), "recording an event");
    const std::vector<ReadyLaunch> resident = ready_launches(kernels, workers);
    launch_range(kernels, resident, streams, 0);
    std::deque<Event> ends = ends_of(streams);
    for (std::uint64_t range = 1; range <= ranges(); ++range) {
      std::deque<Event> next_ends;
      if (range < ranges()) {
        launch_range(kernels, resident, streams, range);
        next_ends = ends_of(streams);
      }
      seconds = wait_for(ends, begin);
      unpack_samples(workers, range - 1);
      ends = std::move(next_ends);
    }
    download(streams[0]);
  }
  workers.for_each(plans_.size(), [&](std::size_t i) {
    Plan<T>& plan = plans_[i];
    std::visit([&](const auto& body) { body.unpack(host_[i], run_.recording, *plan.task); }, plan.body);
  });
  return seconds;
}

template struct Plan<float>;
template struct Plan<double>;
template class Portion<float>;
template class Portion<double>;

}  // namespace evodevo::cuda
