// A body in the device's memory, too large for the chip or moved by a method that has no kernel there: what the kernels
// are told about it.
#pragma once

#include "cuda/layout/answers.hpp"
#include "cuda/layout/features.hpp"
#include "cuda/layout/formats.hpp"
#include "cuda/layout/packing.hpp"

namespace evodevo::cuda {

template <class T>
class Streamed {
 public:
  /// `task`: one whose course has begun. `largest_chip`: bytes of shared memory that a body can have.
  Streamed(const Task& task, const Features& features, std::size_t largest_chip);

  Sizes sizes() const { return sizes_; }
  /// Of the blocks that move the body. Where one block does, they depend on nothing but the body, like all that it
  /// sums.
  unsigned threads() const;
  std::size_t chip_bytes() const { return chip_bytes_; }  ///< of the shared memory of a block that moves it alone
  std::uint32_t masses() const { return static_cast<std::uint32_t>(task_->body->masses.size()); }
  const Features& features() const { return features_; }
  /// From one check to the next, or from the beginning or to the end of the task's steps.
  std::uint64_t check_spans() const { return (since_check() + task_->steps + guard_interval - 1) / guard_interval; }
  unsigned steps_of_span(std::uint64_t span) const;

  /// Writes the body into its part of the host's regions; `device` is where these will be on the device.
  StreamedBody<T> pack(const Regions& host, const Regions& device, const Scene& scene) const;

  /// Reads the task's answer.
  void unpack(const Regions& host, Recording recording, Task& task) const;

 private:
  unsigned since_check() const { return static_cast<unsigned>(task_->course->steps % guard_interval); }
  void reserve();
  void pack_joints(const Regions& host) const;
  void pack_colours(const Regions& host) const;
  void unpack_springs(const Regions& host, Task& task) const;
  /// Where the `row`-th joint of the mass at `index` lies.
  std::uint32_t joint_at(std::uint32_t index, std::uint32_t row) const {
    return lanes * (first_row_[index / lanes] + row) + index % lanes;
  }
  std::size_t joints() const { return std::size_t{lanes} * first_row_.back(); }

  const Task* task_;
  Features features_;
  Sizes sizes_;
  std::size_t chip_bytes_;
  std::vector<std::uint32_t> index_of_;     ///< [masses] by falling number of springs
  std::vector<std::uint32_t> first_row_;    ///< [groups of 32 masses + 1]
  std::vector<std::uint32_t> owned_joint_;  ///< [springs] the one at end a, where the spring's stress is summed
  std::vector<std::uint32_t> colour_;       ///< [springs] where the method asks for it
  std::uint32_t colours_ = 0;

  Section<std::uint32_t> rows_;
  Section<Joint<T>> joints_;
  Section<ColouredSpring<T>> coloured_;
  Section<std::uint32_t> first_of_colour_;
  Section<Actuator> actuators_;
  Section<T> mass_, inverse_mass_;
  Section<Point<T>> positions_, velocities_;
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
