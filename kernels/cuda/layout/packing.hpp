// Layout of arrays in memory regions that host and device share.
#pragma once

#include <cstddef>

namespace evodevo::cuda {

/// The beginning of an array, in bytes from the beginning of its region.
template <class T>
struct Section {
  std::size_t offset = 0;
  T* in(std::byte* region) const { return reinterpret_cast<T*>(region + offset); }
  const T* in(const std::byte* region) const { return reinterpret_cast<const T*>(region + offset); }
};

/// Computes the sections of arrays that are added to a region one after the other, and the size of the region.
class Extent {
 public:
  template <class T>
  Section<T> add(std::size_t count) {
    constexpr std::size_t alignment = 32;
    const Section<T> section{size_};
    size_ += (count * sizeof(T) + alignment - 1) / alignment * alignment;
    return section;
  }
  std::size_t size() const { return size_; }

 private:
  std::size_t size_ = 0;
};

/// The sizes (bytes) of what the kernel reads first, the descriptions of a body's blocks, and of a body's five memory
/// regions: `input` is copied to the device; `state` is copied there and
/// back; `sums` is initially zero on the device and is copied back; `scratch` exists only on the device; `samples`
/// exists only on the host, where the device writes to it.
struct Sizes {
  std::size_t descriptions = 0, input = 0, state = 0, sums = 0, scratch = 0, samples = 0;

  Sizes& operator+=(const Sizes& other) {
    descriptions += other.descriptions;
    input += other.input;
    state += other.state;
    sums += other.sums;
    scratch += other.scratch;
    samples += other.samples;
    return *this;
  }
  std::size_t mirrored() const { return descriptions + input + state + sums; }
  std::size_t on_device() const { return mirrored() + scratch; }
  std::size_t on_host() const { return mirrored() + samples; }
};

/// The room for `count` descriptions, bytes; what follows them is aligned.
template <class Description>
constexpr std::size_t descriptions_bytes(std::size_t count) {
  return (count * sizeof(Description) + 31) / 32 * 32;
}

/// The beginnings of a body's regions, on the host or on the device.
struct Regions {
  std::byte *input, *state, *sums;
  std::byte* scratch = nullptr;  ///< only on the device
  std::byte* samples = nullptr;  ///< in the host's memory, for both

  /// Returns the regions of the next body, which follow those of a body with the given sizes.
  Regions behind(const Sizes& sizes) const {
    return {input + sizes.input, state + sizes.state, sums + sizes.sums, scratch ? scratch + sizes.scratch : nullptr,
            samples ? samples + sizes.samples : nullptr};
  }
};

}  // namespace evodevo::cuda
