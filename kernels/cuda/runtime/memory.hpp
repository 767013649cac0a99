// Memory on the device with a copy on the host, streams and events.
#pragma once

#include <cuda_runtime_api.h>

#include <cstddef>
#include <span>
#include <string>
#include <utility>

#include "cuda/runtime/error.hpp"

namespace evodevo::cuda {

/// A size for messages, in MiB, rounded up.
inline std::string in_mebibytes(std::size_t bytes) {
  return std::to_string((bytes + (std::size_t{1} << 20) - 1) >> 20) + " MiB";
}

/// Memory of the device: a mirrored part, with a copy of the same size on the host, followed by a part that exists only
/// on the device. On the host, the copy is followed by a part that exists only there; the device can write to it. The
/// memory on the host cannot be swapped out.
class MirroredMemory {
 public:
  MirroredMemory() = default;
  MirroredMemory(const MirroredMemory&) = delete;
  MirroredMemory& operator=(const MirroredMemory&) = delete;
  ~MirroredMemory() { release(); }

  /// Whether there is room for `mirrored` bytes on both sides, `more` bytes only on the device and `apart` bytes only
  /// on the host.
  bool holds(std::size_t mirrored, std::size_t more, std::size_t apart = 0) const {
    return mirrored + apart <= host_size_ && mirrored + more <= size_;
  }

  /// Makes room for these sizes; the old content is lost. If it throws OutOfMemory, no memory is held afterwards.
  void resize(std::size_t mirrored, std::size_t more, std::size_t apart = 0) {
    if (holds(mirrored, more, apart)) return;
    try {
      // more than needed, because bodies grow little by little and allocation makes the device wait
      take(rounded(mirrored + more), rounded(mirrored + apart));
    } catch (const OutOfMemory&) {
      take(mirrored + more, mirrored + apart);
    }
  }

  std::byte* device() const { return static_cast<std::byte*>(device_); }
  std::byte* host() const { return static_cast<std::byte*>(host_); }
  std::size_t size() const { return size_; }  ///< on the device, bytes

 private:
  static std::size_t rounded(std::size_t size) {
    constexpr std::size_t piece = std::size_t{32} << 20;
    return (size + piece - 1) / piece * piece;
  }

  void take(std::size_t size, std::size_t host_size) {
    release();
    try {
      check(cudaMalloc(&device_, size), "allocating " + in_mebibytes(size) + " of the GPU's memory");
      check(cudaMallocHost(&host_, host_size), "allocating " + in_mebibytes(host_size) + " of the host's memory");
    } catch (const OutOfMemory&) {
      release();
      throw;
    }
    size_ = size;
    host_size_ = host_size;
  }

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

/// A CUDA stream: the device executes the operations of a stream in their order.
class Stream {
 public:
  /// Operations of an `urgent` stream begin before those that wait in other streams.
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

/// A guard whose destructor waits until the streams are idle, even when an exception is thrown, so that memory is not
/// freed while the device still uses it.
class StreamsAtRest {
 public:
  explicit StreamsAtRest(std::span<const Stream> streams) : streams_(streams) {}
  StreamsAtRest(const StreamsAtRest&) = delete;
  StreamsAtRest& operator=(const StreamsAtRest&) = delete;
  ~StreamsAtRest() {
    for (const Stream& stream : streams_) cudaStreamSynchronize(stream);  // its failure is reported elsewhere
  }

 private:
  std::span<const Stream> streams_;
};

/// A CUDA event: a point in the order of a stream.
class Event {
 public:
  /// A thread that waits for a `blocking` event sleeps; otherwise it polls.
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

/// Waits until the device has executed all operations of a stream so far. The thread sleeps, because others need the
/// core.
inline void wait_for(cudaStream_t stream, const std::string& what) {
  const Event done(true);
  check(cudaEventRecord(done, stream), "recording an event");
  check(cudaEventSynchronize(done), what);
}

}  // namespace evodevo::cuda
