#include "cuda/layout/sampling.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>

#include "analysis/computed_materials.hpp"
#include "analysis/guard.hpp"
#include "analysis/sampling.hpp"

namespace evodevo::cuda {
namespace {

// A range should be long, because the device is not quite busy where it ends, and its samples should be few, because
// those of the last range are read when the device has nothing left to do.
constexpr double wanted_spans = 10;           // in a range
constexpr double wanted_bytes = 8 << 10;      // of a body's samples in a range, if it has that many spans
constexpr double largest_bytes = 1024 << 10;  // even if it then has fewer
// Blocks are not interrupted. While a batch is simulated for long, shorter ranges let others with higher priority begin
// in between: evo-devo.toml with 1,024 robots runs 1.3 times as fast as with all spans in one range.
constexpr double most_spans = 50;

std::size_t bytes_of_lists(const Channels& channels, std::size_t masses, std::size_t forces) {
  std::size_t numbers = 0;
  if (channels.positions) numbers += 3 * masses;
  if (channels.velocities) numbers += 3 * masses;
  if (channels.contacts) numbers += masses;
  if (channels.forces) numbers += forces;
  return numbers * sizeof(float);
}

std::uint32_t bits_of(const Channels& channels) {
  return (channels.centre ? centre_bit : 0) | (channels.box ? box_bit : 0) | (channels.contact ? contact_bit : 0) |
         (channels.work ? work_bit : 0) | (channels.positions ? positions_bit : 0) |
         (channels.velocities ? velocities_bit : 0) | (channels.contacts ? contacts_bit : 0) |
         (channels.forces ? forces_bit : 0);
}

/// Grows the calling thread's heap for the lists of samples by many lists at once, because whenever a heap grows, the
/// address space of the process is locked for all threads.
class Room {
 public:
  void make(std::size_t bytes) {
    constexpr std::size_t piece = 96 << 10;  // larger pieces are not taken from the heap
    if (bytes > left_) {
      void* volatile room = std::malloc(piece);  // volatile: the compiler must not remove it
      std::free(room);
      left_ = piece;
    }
    left_ -= std::min(left_, bytes);
  }

 private:
  std::size_t left_ = 0;
};

std::uint64_t since_check(const Task& task) { return task.course ? task.course->steps % guard_interval : 0; }

Vec3 vector_of(const double* numbers) { return {numbers[0], numbers[1], numbers[2]}; }

}  // namespace

std::uint64_t span_of_sample(const Task& task, std::uint64_t step) {
  return (since_check(task) + step - 1) / guard_interval;
}

std::uint64_t spans_per_range(std::span<Task* const> tasks) {
  double bytes = 0, spans = 0;
  for (const Task* task : tasks) {
    if (task->sampled_at.empty()) continue;
    for (const auto& [step, channels] : task->sampled_at)
      bytes += static_cast<double>(sizeof(ReducedSample) +
                                   bytes_of_lists(channels, task->body->masses.size(), task->body->springs.size()));
    spans += static_cast<double>(task->steps) / guard_interval;
  }
  constexpr std::uint64_t all = std::uint64_t{1} << 32;
  if (bytes == 0) return all;
  const double per_span = bytes / std::max(spans, 1.0);
  const double enough = std::max(wanted_spans, wanted_bytes / per_span);
  return static_cast<std::uint64_t>(std::clamp(std::min(enough, largest_bytes / per_span), 1.0, most_spans));
}

Channels channels_on_device(const Task& task) {
  Channels channels;
  for (const SamplePoint& point : task.sampled_at)
    if (point.step > 0) channels = channels | point.channels;
  return channels;
}

void take_first_samples(Task& task, Materials materials) {
  task.samples.clear();
  if (task.sampled_at.empty() || task.sampled_at.front().step > 0) return;
  Body coded;  // the body with rounded materials, if materials are computed
  if (materials == Materials::computed) {
    coded = *task.body;
    coded.materials = simulated_materials(coded, materials);
  }
  const Body& body = materials == Materials::computed ? coded : *task.body;
  for (const auto& [step, channels] : task.sampled_at) {
    if (step > 0) break;
    Sample& sample = task.samples.emplace_back(sample_of(body, *task.state, task.state->time, channels));
    if (channels.contacts) sample.contacts.assign(body.masses.size(), 0);
  }
}

void take_samples_of_nothing(Task& task, Course course) {
  const std::uint64_t begin = course.steps;
  while (task.samples.size() < task.sampled_at.size()) {
    course.steps = begin + task.sampled_at[task.samples.size()].step;
    task.samples.push_back({.time = course.time(task.dt)});
  }
}

SampleLayout::SampleLayout(const Task& task, std::uint64_t spans_per_range, std::size_t masses, std::size_t forces)
    : task_(&task), spans_per_range_(spans_per_range), masses_(masses), forces_(forces) {
  ranges_ = span_of_sample(task, task.steps) / spans_per_range + 1;
  points_.reserve(task.sampled_at.size());
  std::uint64_t range = 0;
  std::size_t used = 0;
  for (const SamplePoint& point : task.sampled_at) {
    if (point.step == 0) {
      ++first_;
      continue;
    }
    const std::uint64_t span = span_of_sample(task, point.step), end = since_check(task) + point.step;
    if (span / spans_per_range != range) used = 0;
    range = span / spans_per_range;
    const bool last = end % guard_interval == 0 || point.step == task.steps;
    const std::uint64_t first = span == 0 ? since_check(task) : span * guard_interval;
    points_.push_back({point, range, span, last ? 0 : static_cast<unsigned>(end - first), used});
    used += bytes_of(point.channels);
    half_ = std::max(half_, used);
  }
  for (Point& point : points_) point.offset += point.range % 2 * half_;
}

std::size_t SampleLayout::bytes_of(const Channels& channels) const {
  const std::size_t lists = bytes_of_lists(channels, masses_, forces_);
  return sizeof(ReducedSample) + (lists + 31) / 32 * 32;
}

void SampleLayout::reserve(Extent& input, Extent& sums) {
  if (empty()) return;
  const Channels channels = channels_on_device(*task_);
  marks_ = input.add<SampleMark>(points_.size() + 1);
  mass_share_ = input.add<double>(masses_);
  contact_steps_ = sums.add<std::uint32_t>(channels.contact || channels.contacts ? masses_ : 0);
}

Sampling SampleLayout::pack(std::span<const std::uint32_t> index_of, const Regions& host, const Regions& device) const {
  if (empty()) return {};
  SampleMark* mark = marks_.in(host.input);
  for (const Point& point : points_)
    *mark++ = {point.of_task.step, reinterpret_cast<unsigned char*>(device.samples + point.offset),
               bits_of(point.of_task.channels)};
  *mark = {.step = std::numeric_limits<std::uint64_t>::max()};
  double total = 0;
  for (const Mass& mass : task_->body->masses) total += mass.mass;
  double* const share = mass_share_.in(host.input);
  std::fill(share, share + masses_, -1.0);  // padding, also between the masses if some have been removed
  for (std::size_t i = 0; i < index_of.size(); ++i)
    share[index_of[i]] = total > 0 ? task_->body->masses[i].mass / total : 0;
  return {.marks = marks_.in(device.input),
          .mass_share = mass_share_.in(device.input),
          .contact_steps = contact_steps_.in(device.sums),
          .spans_per_range = spans_per_range_,
          .count = static_cast<std::uint32_t>(points_.size()),
          .masses = static_cast<std::uint32_t>(masses_)};
}

/// Reads a list of vectors, [3][masses_], and returns its end.
const float* SampleLayout::read_vectors(const float* from, std::span<const std::uint32_t> index_of,
                                        std::vector<float>& to) const {
  to.reserve(3 * index_of.size());
  for (const std::uint32_t index : index_of)
    for (std::size_t axis = 0; axis < 3; ++axis) to.push_back(from[axis * masses_ + index]);
  return from + 3 * masses_;
}

void SampleLayout::unpack(std::uint64_t range, std::span<const std::uint32_t> index_of,
                          std::span<const std::uint32_t> force_of, const Regions& host, Task& task) const {
  if (range == 0) task.samples.resize(first_);  // an earlier attempt may have failed for want of memory
  task.samples.reserve(task.sampled_at.size());
  Room room;
  const auto first = std::ranges::lower_bound(points_, range, {}, &Point::range);
  for (auto point = first; point != points_.end() && point->range == range; ++point) {
    const Channels& channels = point->of_task.channels;
    const auto& reduced = *reinterpret_cast<const ReducedSample*>(host.samples + point->offset);
    const auto* list = reinterpret_cast<const float*>(&reduced + 1);
    Course course = *task.course;
    course.steps += point->of_task.step;
    Sample& sample = task.samples.emplace_back();
    room.make(bytes_of_lists(channels, index_of.size(), force_of.size()));
    sample.time = course.time(task.dt);
    if (channels.centre) sample.centre = vector_of(reduced.centre), sample.velocity = vector_of(reduced.velocity);
    if (channels.box) sample.box = {-1 * vector_of(reduced.low), vector_of(reduced.high)};
    // a body that has diverged leaves any numbers here; its samples are discarded later
    if (channels.contact)
      sample.contact_steps = static_cast<std::uint64_t>(std::max(0.0, std::min(reduced.contact_steps, 0x1p62)));
    if (channels.work) sample.work = reduced.work;
    if (channels.positions) list = read_vectors(list, index_of, sample.positions);
    if (channels.velocities) list = read_vectors(list, index_of, sample.velocities);
    if (channels.contacts) {
      const auto* steps = reinterpret_cast<const std::uint32_t*>(list);
      sample.contacts.reserve(index_of.size());
      for (const std::uint32_t index : index_of) sample.contacts.push_back(steps[index]);
      list += masses_;
    }
    if (channels.forces) {
      sample.forces.reserve(force_of.size());
      for (const std::uint32_t index : force_of) sample.forces.push_back(list[index]);
    }
  }
}

}  // namespace evodevo::cuda
