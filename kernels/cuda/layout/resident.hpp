// A body whose state stays on the chip (resident.cu), on the host's side.
//
//   task ─► arrange ─► pack: descriptions and regions for the device ─► resident.cu ─► unpack: the task's answer
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "analysis/computed_materials.hpp"
#include "cuda/layout/answers.hpp"
#include "cuda/layout/arrangement/arranged_body.hpp"
#include "cuda/layout/chip_memory.hpp"
#include "cuda/layout/features.hpp"
#include "cuda/layout/force_range.hpp"
#include "cuda/layout/formats.hpp"
#include "cuda/layout/packing.hpp"
#include "cuda/layout/sampling.hpp"

namespace evodevo::cuda {

inline constexpr std::size_t slots_read_ahead = lanes * rows_read_ahead;

/// The numbers of blocks that simulate a body, in ascending order. Others would leave multiprocessors idle: those of a
/// cluster are neighbours, in groups of 16 or 18.
inline constexpr unsigned cluster_sizes[] = {1, 2, 3, 4, 5, 8, 16};

/// What a device offers to a body.
struct Room {
  std::size_t shared_bytes;         ///< shared memory of a block
  unsigned largest_cluster = 1;     ///< blocks that can simulate a body together
  unsigned wanted_blocks = 1;       ///< for long runs; more than a body needs if there are few bodies
  unsigned at_once = Target::many;  ///< as in Target
};

/// How a body is laid out on the chip. It refers to its task, which must outlive it.
template <class T>
class Resident {
 public:
  /// Arranges the body of `task`, whose course has begun, for the smallest cluster of blocks whose shared memory has
  /// room for its springs (in double precision, for its masses), or for the largest. Returns nothing if not even its
  /// masses fit; that does not depend on what is recorded or sampled, and neither do the steps of the table. Only the
  /// rounding of work and, in double precision, of samples depends on the arrangement. So a body whose work is recorded
  /// is arranged without regard to its earlier life, and in both cases to the number of bodies: it gets no more blocks
  /// than necessary. A range of samples has `spans_per_range` check spans.
  static std::optional<Resident> arrange(const Task& task, const Features& features, const Room& room,
                                         std::uint64_t spans_per_range = 1);

  /// The part of a block's `shared_bytes` that is available to a body; the kernel and the system need the rest.
  static std::size_t largest_chip(std::size_t shared_bytes, bool in_a_cluster = false);

  ResidentForm form() const;
  const Features& features() const { return features_; }
  const std::shared_ptr<const ArrangedBody>& arranged() const { return arranged_; }
  unsigned blocks() const { return static_cast<unsigned>(arranged_->blocks().size()); }
  unsigned threads() const { return 32 * shape().block; }
  std::size_t slots() const { return arranged_->slots(); }
  /// The number of masses with the padding that fills groups; masses may have any indices below it.
  std::size_t padded_masses() const { return arranged_->padded_masses(); }
  std::size_t chip_bytes() const { return chip_.size; }
  Sizes sizes() const { return sizes_; }
  const SampleLayout& samples() const { return samples_; }

  /// Writes the body into its regions on the host, and its description for each block to `to`. `device`: the same
  /// regions on the device.
  void pack(const Regions& host, const Regions& device, const Scene& scene, ResidentBody<T>* to) const;

  /// Reads the answer, the motion and the records from the regions on the host into the task.
  void unpack(const Regions& host, Recording recording, Task& task) const;
  /// Reads the samples of a range into the task.
  void unpack_samples(std::uint64_t range, const Regions& host, Task& task) const;

 private:
  Resident(const Task& task, const Features& features, unsigned blocks, const Target& target, std::size_t needs);
  void divide_chip(bool with_rates, std::size_t shared_bytes);
  std::size_t waves_in(std::size_t slots) const;
  std::size_t coefficients_in(std::size_t slots) const;
  void reserve();
  std::vector<typename FixedPoint<T>::Integer> materials_in_records(const CodedMaterials& coded) const;
  static unsigned wanted_blocks(const Task& task, const Features& features, const Room& room);
  static std::size_t needs_of(const Features& features, const Room& room);
  static bool may_suffice(const Task& task, const Features& features, unsigned blocks, bool is_last, std::size_t chip);
  bool is_fast(std::size_t chip) const;
  std::size_t masses_bytes() const;
  void pack_records(Record<T>* to, const CodedMaterials& coded) const;
  template <class Number, class Of>
  void pack_by_slot(const Of& number_of, Number* to) const;
  void pack_materials(const Regions& host, const CodedMaterials& coded) const;
  void pack_blocks(const Regions& host) const;
  void place_block(std::size_t number, ResidentBody<T>& body) const;
  void pack_masses(const Regions& host) const;
  std::vector<Vec3> dashpot_velocities(const Regions& host) const;
  void unpack_springs(const Regions& host, Task& task) const;

  const Shape& shape() const { return arranged_->blocks().front().arrangement.shape; }
  const ForceRange& range() const { return task_->course->forces; }

  const Task* task_;
  Features features_;
  std::shared_ptr<const ArrangedBody> arranged_;
  ChipMemory chip_;
  bool records_on_chip_ = true;

  Sizes sizes_;
  SampleLayout samples_;
  Section<Record<T>> records_;
  Section<std::uint32_t> waves_;
  Section<std::uint32_t> first_group_, group_ends_;  // of all blocks
  Section<HaloCopy> copies_;                         // likewise
  Section<Actuator> actuators_;
  Section<T> coefficients_;
  Section<T> mass_, inverse_mass_;
  Section<typename FixedPoint<T>::Integer> start_;
  Section<T> motion_[6], dashpot_velocity_[3];
  Section<Answer> answer_;
  Section<double> stress_;
  Section<T> recent_stress_;
  Section<typename FixedPoint<T>::Integer> peak_;
  Section<double> powers_, tensions_;
};

extern template class Resident<float>;
extern template class Resident<double>;

}  // namespace evodevo::cuda
