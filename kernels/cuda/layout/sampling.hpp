// The samples of a task on the host's side: where the device writes them, and how they are read.
//
//   task ─► SampleLayout ─► pack: marks, weights ─► kernels ─► unpack, range by range: the task's samples
//
// A run is divided into ranges of check spans. The memory for samples has two halves: the samples of a range are read
// from one half while the device writes those of the next range to the other. So the memory does not grow with the
// length of the run.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/simulator.hpp"
#include "cuda/layout/formats.hpp"
#include "cuda/layout/packing.hpp"

namespace evodevo::cuda {

/// The check span with the last step before the sample at step `step` (at least 1) of a task. Spans are counted from
/// the task's beginning.
std::uint64_t span_of_sample(const Task& task, std::uint64_t step);

/// The number of check spans that a range has in a run of these tasks. If nothing is sampled, a range has all spans.
std::uint64_t spans_per_range(std::span<Task* const> tasks);

/// The channels of any sample that the device takes; samples at step 0 are taken by the host.
Channels channels_on_device(const Task& task);

/// Sets the task's samples to those at step 0, which the host takes. `materials` says how springs get their materials.
void take_first_samples(Task& task, Materials materials);

/// Takes the samples of a task without masses, or without steps, after step 0. `course` is that at its beginning.
void take_samples_of_nothing(Task& task, Course course);

/// Where the samples of a task are. It refers to the task, which must outlive it.
class SampleLayout {
 public:
  SampleLayout() = default;
  /// `masses` and `forces` are the lengths of the lists by mass and by spring that the device writes. They may be
  /// longer than those of the body, whose masses may have any indices below `masses`.
  SampleLayout(const Task& task, std::uint64_t spans_per_range, std::size_t masses, std::size_t forces);

  bool empty() const { return points_.empty(); }
  std::uint64_t ranges() const { return ranges_; }  ///< in which the body moves
  /// The size of the memory for samples, bytes.
  std::size_t bytes() const { return empty() || points_.back().range == 0 ? half_ : 2 * half_; }

  /// Adds the arrays that the device needs to a body's regions.
  void reserve(Extent& input, Extent& sums);
  /// Writes the arrays; index_of[i] is the device's index of mass i.
  Sampling pack(std::span<const std::uint32_t> index_of, const Regions& host, const Regions& device) const;

  /// Reads the samples of a range into the task. index_of[i] and force_of[i] are the device's indices of mass i and of
  /// spring i.
  void unpack(std::uint64_t range, std::span<const std::uint32_t> index_of, std::span<const std::uint32_t> force_of,
              const Regions& host, Task& task) const;

  /// Calls function(span, step) for each sample of a range: the check span after whose step `step` it is taken; with 0,
  /// after its last step.
  template <class Function>
  void for_each_in(std::uint64_t range, const Function& function) const {
    for (const Point& point : points_)
      if (point.range == range) function(point.span, point.step_of_span);
  }

 private:
  struct Point {
    SamplePoint of_task;
    std::uint64_t range, span;
    unsigned step_of_span;  ///< 0: the last
    std::size_t offset;     ///< from the beginning of the memory
  };

  std::size_t bytes_of(const Channels& channels) const;
  const float* read_vectors(const float* from, std::span<const std::uint32_t> index_of, std::vector<float>& to) const;

  const Task* task_ = nullptr;
  std::uint64_t spans_per_range_ = 0, ranges_ = 1;
  std::size_t masses_ = 0, forces_ = 0, half_ = 0, first_ = 0;
  std::vector<Point> points_;
  Section<SampleMark> marks_;
  Section<double> mass_share_;
  Section<std::uint32_t> contact_steps_;
};

}  // namespace evodevo::cuda
