// Memory on the device and its image on the host.
#pragma once

#include <cuda_runtime_api.h>

#include <cstddef>
#include <utility>

#include "cuda/error.hpp"

namespace evodevo::cuda {

/// Memory of the device together with as much on the host that copies go to and come from, and more that is on the
/// device alone.
class MirroredMemory {
 public:
  MirroredMemory() = default;
  MirroredMemory(const MirroredMemory&) = delete;
  MirroredMemory& operator=(const MirroredMemory&) = delete;
  ~MirroredMemory() { release(); }

  /// Makes room for at least `mirrored` bytes on both and, behind them, `more` on the device; what was there is lost.
  void resize(std::size_t mirrored, std::size_t more = 0) {
    if (mirrored <= host_size_ && mirrored + more <= size_) return;
    // bodies grow by little, and taking memory makes the device wait
    constexpr std::size_t piece = std::size_t{32} << 20;
    mirrored = (mirrored + piece - 1) / piece * piece;
    const std::size_t size = mirrored + (more + piece - 1) / piece * piece;
    release();
    check(cudaMalloc(&device_, size), "taking " + std::to_string(size >> 20) + " MiB of the GPU's memory");
    size_ = size;
    check(cudaMallocHost(&host_, mirrored), "taking " + std::to_string(mirrored >> 20) + " MiB of the host's memory");
    host_size_ = mirrored;
  }

  std::byte* device() const { return static_cast<std::byte*>(device_); }
  std::byte* host() const { return static_cast<std::byte*>(host_); }
  std::size_t size() const { return size_; }  ///< on the device, bytes

 private:
  void release() {
    cudaFree(device_);
    cudaFreeHost(host_);
    device_ = host_ = nullptr;
    size_ = host_size_ = 0;
  }

  void* device_ = nullptr;
  void* host_ = nullptr;
  std::size_t size_ = 0, host_size_ = 0;
};

/// The order in which the device works off what it is given.
class Stream {
 public:
  /// What is in an `urgent` stream is begun before what waits in others.
  explicit Stream(bool urgent = false) {
    int least = 0, greatest = 0;
    check(cudaDeviceGetStreamPriorityRange(&least, &greatest), "asking for the priorities of streams");
    check(cudaStreamCreateWithPriority(&stream_, cudaStreamNonBlocking, urgent ? greatest : least), "opening a stream");
  }
  Stream(Stream&& other) noexcept : stream_(std::exchange(other.stream_, nullptr)) {}
  Stream& operator=(Stream&&) = delete;
  ~Stream() {
    if (stream_) cudaStreamDestroy(stream_);
  }
  operator cudaStream_t() const { return stream_; }

 private:
  cudaStream_t stream_ = nullptr;
};

/// A moment in a stream.
class Event {
 public:
  /// A thread that waits for a `blocking` event sleeps; else it keeps asking.
  explicit Event(bool blocking = false) {
    check(cudaEventCreateWithFlags(&event_, blocking ? cudaEventBlockingSync : cudaEventDefault), "making an event");
  }
  Event(const Event&) = delete;
  Event& operator=(const Event&) = delete;
  ~Event() { cudaEventDestroy(event_); }
  operator cudaEvent_t() const { return event_; }

 private:
  cudaEvent_t event_ = nullptr;
};

}  // namespace evodevo::cuda
