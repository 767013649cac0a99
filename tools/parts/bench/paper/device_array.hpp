// Arrays in the memory of the device.
#pragma once

#include <cuda_runtime_api.h>

#include <cstddef>
#include <string>
#include <vector>

#include "cuda/runtime/error.hpp"

namespace evodevo::tools::bench {

/// An array in the memory of the device, initially zero.
template <class T>
class DeviceArray {
 public:
  explicit DeviceArray(std::size_t count) : count_(count) {
    cuda::check(cudaMalloc(&data_, bytes()),
                "allocating " + std::to_string(bytes() >> 20) + " MiB of the GPU's memory");
    clear();
  }
  explicit DeviceArray(const std::vector<T>& values) : DeviceArray(values.size()) { upload(values); }
  DeviceArray(const DeviceArray&) = delete;
  DeviceArray& operator=(const DeviceArray&) = delete;
  ~DeviceArray() { cudaFree(data_); }

  T* data() const { return static_cast<T*>(data_); }

  void clear() { cuda::check(cudaMemset(data_, 0, bytes()), "clearing the GPU's memory"); }
  void upload(const std::vector<T>& values) {
    cuda::check(cudaMemcpy(data_, values.data(), bytes(), cudaMemcpyHostToDevice), "copying bodies to the GPU");
  }
  std::vector<T> download() const {
    std::vector<T> values(count_);
    cuda::check(cudaMemcpy(values.data(), data_, bytes(), cudaMemcpyDeviceToHost), "copying bodies from the GPU");
    return values;
  }

 private:
  std::size_t bytes() const { return count_ * sizeof(T); }

  void* data_ = nullptr;
  std::size_t count_;
};

}  // namespace evodevo::tools::bench
