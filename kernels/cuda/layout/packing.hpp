// Arrays one behind the other in memory that the host fills and the device reads.
#pragma once

#include <cstddef>

namespace evodevo::cuda {

/// Where an array begins, in bytes from the beginning of its region.
template <class T>
struct Section {
  std::size_t offset = 0;
  T* in(std::byte* region) const { return reinterpret_cast<T*>(region + offset); }
  const T* in(const std::byte* region) const { return reinterpret_cast<const T*>(region + offset); }
};

/// The size of a region while arrays are added to it.
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

/// The four kinds of memory of a body: what only the device reads, what goes there and comes back, what begins as zeros
/// there and comes back, and what is nowhere but there.
struct Sizes {
  std::size_t input = 0, state = 0, sums = 0, scratch = 0;

  Sizes& operator+=(const Sizes& other) {
    input += other.input;
    state += other.state;
    sums += other.sums;
    scratch += other.scratch;
    return *this;
  }
  std::size_t mirrored() const { return input + state + sums; }
  std::size_t total() const { return mirrored() + scratch; }
};

struct Regions {
  std::byte *input, *state, *sums;
  std::byte* scratch = nullptr;  ///< on the device alone

  Regions behind(const Sizes& sizes) const {
    return {input + sizes.input, state + sizes.state, sums + sizes.sums, scratch ? scratch + sizes.scratch : nullptr};
  }
};

}  // namespace evodevo::cuda
