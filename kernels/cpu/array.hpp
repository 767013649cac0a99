// Arrays aligned for SIMD vectors.
#pragma once

#include <hwy/aligned_allocator.h>

#include <algorithm>
#include <cstddef>

namespace evodevo::cpu {

/// An array of `size` numbers, initially zero, aligned for the widest SIMD vectors.
template <class T>
class Array {
 public:
  Array() = default;
  explicit Array(std::size_t size) : data_(hwy::AllocateAligned<T>(std::max<std::size_t>(size, 1))), size_(size) {
    std::fill_n(data_.get(), size, T{});
  }

  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }
  std::size_t size() const { return size_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  void clear() { std::fill_n(data_.get(), size_, T{}); }

 private:
  hwy::AlignedFreeUniquePtr<T[]> data_;
  std::size_t size_ = 0;
};

}  // namespace evodevo::cpu
