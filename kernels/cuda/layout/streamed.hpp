// A body that is kept in the device's memory (streamed.cu, implicit.cu, xpbd.cu), on the host's side: bodies too large
// for the chip, and all bodies of the methods implicit and xpbd.
//
//   task ─► constructor: layout ─► pack: description and regions for the device ─► kernels ─► unpack: the task's answer
#pragma once

#include "cuda/layout/answers.hpp"
#include "cuda/layout/features.hpp"
#include "cuda/layout/formats.hpp"
#include "cuda/layout/packing.hpp"
#include "cuda/layout/sampling.hpp"

namespace evodevo::cuda {

/// How a body is laid out in the device's memory. It refers to its task, which must outlive it.
template <class T>
class Streamed {
 public:
  /// The course of `task` must have begun. `largest_chip` is the shared memory that is available to a body, bytes. A
  /// range of samples has `spans_per_range` check spans.
  Streamed(const Task& task, const Features& features, std::size_t largest_chip, std::uint64_t spans_per_range);

  Sizes sizes() const { return sizes_; }
  const SampleLayout& samples() const { return samples_; }
  /// The number of threads of each block that simulates the body. If one block simulates the whole body, this number,
  /// and with it the order of the block's sums, depends only on the body.
  unsigned threads() const;
  std::size_t chip_bytes() const { return chip_bytes_; }  ///< shared memory for the body, bytes; 0: not used
  std::uint32_t masses() const { return static_cast<std::uint32_t>(task_->body->masses.size()); }
  const Features& features() const { return features_; }
  /// The number of check spans: a span goes from one check, or the beginning of the task, to the next check or its end.
  std::uint64_t check_spans() const { return (since_check() + task_->steps + guard_interval - 1) / guard_interval; }
  unsigned steps_of_span(std::uint64_t span) const;

  /// Writes the body into its regions on the host, and returns its description for the kernels. `device`: the same
  /// regions on the device.
  StreamedBody<T> pack(const Regions& host, const Regions& device, const Scene& scene) const;

  /// Reads the answer, the motion and the records from the regions on the host into the task.
  void unpack(const Regions& host, Recording recording, Task& task) const;
  /// Reads the samples of a range into the task.
  void unpack_samples(std::uint64_t range, const Regions& host, Task& task) const;

 private:
  unsigned since_check() const { return static_cast<unsigned>(task_->course->steps % guard_interval); }
  void reserve();
  void pack_joints(const Regions& host) const;
  void pack_colours(const Regions& host) const;
  void unpack_springs(const Regions& host, Task& task) const;
  /// The index of the `row`-th joint of the mass with index `index`.
  std::uint32_t joint_at(std::uint32_t index, std::uint32_t row) const {
    return lanes * (first_row_[index / lanes] + row) + index % lanes;
  }
  std::size_t joints() const { return std::size_t{lanes} * first_row_.back(); }

  const Task* task_;
  Features features_;
  Sizes sizes_;
  std::size_t chip_bytes_;
  std::vector<std::uint32_t> index_of_;     ///< [masses] device index of each mass, in descending order of degree
  std::vector<std::uint32_t> first_row_;    ///< [groups of 32 masses + 1]
  std::vector<std::uint32_t> owned_joint_;  ///< [springs] the joint at end a, where the spring's stress is summed
  std::vector<std::uint32_t> colour_;       ///< [springs] if the method asks for colours
  std::uint32_t colours_ = 0;
  SampleLayout samples_;

  Section<std::uint32_t> rows_;
  Section<Joint<T>> joints_;
  Section<ColouredSpring<T>> coloured_;
  Section<std::uint32_t> first_of_colour_;
  Section<Actuator> actuators_;
  Section<T> dashpots_;
  Section<T> mass_, inverse_mass_;
  Section<Point<T>> positions_, velocities_, dashpot_velocities_;
  Section<Answer> answer_;
  Section<Entry<T>> table_;
  Section<T> rates_;
  Section<double> stress_, power_;
  Section<T> peak_;
  Section<double> powers_, tensions_;
  Section<T> scratch_;
};

extern template class Streamed<float>;
extern template class Streamed<double>;

}  // namespace evodevo::cuda
