// A body whose state stays on the chip (resident.cu), on the host's side.
//
//   task ─► arrange ─► pack: description and regions for the device ─► resident.cu ─► unpack: the task's answer
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "analysis/computed_materials.hpp"
#include "cuda/layout/answers.hpp"
#include "cuda/layout/arrangement.hpp"
#include "cuda/layout/features.hpp"
#include "cuda/layout/formats.hpp"
#include "cuda/layout/packing.hpp"
#include "cuda/layout/sampling.hpp"

namespace evodevo::cuda {

/// The division of a block's shared memory: offsets and size in bytes.
struct ChipMemory {
  std::size_t table_offset = 0, rate_offset = 0, dashpot_offset = 0, record_offset = 0, wave_offset = 0, size = 0;
  std::uint32_t table_steps = 1;
};

/// The range of forces for a body. The largest force is the maximum of: the force of its strongest spring at twice its
/// rest length, or at three times its rest length if muscles drive the body (in resonance, springs stretch by more than
/// their rest length); twice the largest current force of a spring; the force that stops the masses' motion; and the
/// body's weight. The last three can be the maximum if springs are soft or short. Dashpots add to each the share 2
/// zeta, with the largest damping ratio zeta: that is the largest force of a dashpot relative to that of its spring
/// while both swing freely. If that is more, they add the force with which a dashpot stops a fall by the body's own
/// size in a landing.
template <class T>
ForceRange force_range(const Body& body, const State& state, const Scene& scene);

/// A body's arrangement, kept from one run to the next. It depends only on the body's outline.
class ArrangedBody final : public Preparation {
 public:
  ArrangedBody(const Body& body, Arrangement arrangement, unsigned largest_block);

  /// The arrangement for `body`: `earlier` if it fits, otherwise a new one that keeps as much of `earlier` as possible.
  static std::shared_ptr<const ArrangedBody> of(const Body& body, unsigned largest_block,
                                                const std::shared_ptr<const Preparation>& earlier);

  const Arrangement arrangement;

 private:
  Outline outline_;
  unsigned largest_block_;
};

/// How a body is laid out on the chip. It refers to its task, which must outlive it.
template <class T>
class Resident {
 public:
  /// Arranges the body of `task`, whose course has begun, for blocks with up to `shared_bytes` of shared memory.
  /// Returns nothing if the body does not fit. Neither that nor the steps of the table depend on what is recorded or
  /// sampled. A range of samples has `spans_per_range` check spans.
  static std::optional<Resident> arrange(const Task& task, const Features& features, std::size_t shared_bytes,
                                         std::uint64_t spans_per_range = 1);

  /// The part of `shared_bytes` that is available to a body; the kernel and the system need the rest.
  static std::size_t largest_chip(std::size_t shared_bytes);

  ResidentForm form() const;
  const Features& features() const { return features_; }
  unsigned threads() const { return 32 * arrangement().shape.block; }
  std::size_t slots() const { return arrangement().slots.size(); }
  /// The number of masses with the padding that fills groups; masses may have any indices below it.
  std::size_t padded_masses() const { return lanes * arrangement().groups; }
  std::size_t chip_bytes() const { return chip_.size; }
  Sizes sizes() const { return sizes_; }
  const SampleLayout& samples() const { return samples_; }

  /// Writes the body into its regions on the host, and returns its description for the kernel. `device`: the same
  /// regions on the device.
  ResidentBody<T> pack(const Regions& host, const Regions& device, const Scene& scene) const;

  /// Reads the answer, the motion and the records from the regions on the host into the task.
  void unpack(const Regions& host, Recording recording, Task& task) const;
  /// Reads the samples of a range into the task.
  void unpack_samples(std::uint64_t range, const Regions& host, Task& task) const;

 private:
  Resident(const Task& task, const Features& features);
  void divide_chip(bool with_rates, std::size_t shared_bytes);
  std::size_t waves_in(std::size_t slots) const;
  void reserve();
  std::vector<typename FixedPoint<T>::Integer> materials_in_records(const MaterialUnits& units) const;
  void pack_records(Record<T>* to, const MaterialUnits& units) const;
  void pack_waves(std::uint32_t* to, const MaterialUnits& units) const;
  void pack_masses(const Regions& host) const;
  std::vector<Vec3> dashpot_velocities(const Regions& host) const;
  void unpack_springs(const Regions& host, Task& task) const;

  const Arrangement& arrangement() const { return arranged_->arrangement; }
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
  Section<std::uint32_t> first_group_, group_ends_;
  Section<Actuator> actuators_;
  Section<T> dashpots_;
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
