// Code shared by resident.cu and the two ways to get a spring's material (materials/): the form of the body and access
// to shared memory.
#pragma once

#include "cuda/device/check.cuh"

namespace evodevo::cuda {

constexpr unsigned masses_per_thread = EVODEVO_MASSES;     // masses that a thread moves
constexpr bool chunked = EVODEVO_CHUNKED;                  // whether warps have more rows than one chunk
constexpr bool records_on_chip = EVODEVO_RECORDS_ON_CHIP;  // otherwise springs are streamed from the device's memory
constexpr bool clustered = EVODEVO_CLUSTERED;              // whether a cluster of blocks simulates a body
constexpr unsigned offset_shift = EVODEVO_OFFSET_SHIFT;    // left shift that turns offsets of masses into bytes
constexpr unsigned unrolled_rows = EVODEVO_ROWS;           // springs of a thread in an unrolled loop
using Body = ResidentBody<Number>;

extern __shared__ __align__(16) unsigned char chip[];

template <class T>
__device__ __forceinline__ T& on_chip(unsigned offset) {
  return *reinterpret_cast<T*>(chip + offset);
}

/// Tells the compiler that a pointer is to the device's memory and not to shared memory.
template <class T>
__device__ __forceinline__ T* in_memory(T* pointer) {
  __builtin_assume(__isGlobal(pointer));
  return pointer;
}

/// An array that is copied onto the chip if there is room: the copy, or the original.
template <class T>
__device__ __forceinline__ const T* array_of(const T* in_device, unsigned offset) {
  return records_on_chip ? &on_chip<T>(offset) : in_memory(in_device);
}

/// Copies `count` elements of such an array onto the chip.
template <class T>
__device__ __forceinline__ void copy_to_chip(const T* from, unsigned offset, unsigned count) {
  T* to = &on_chip<T>(offset);
  for (unsigned i = threadIdx.x; i < count; i += blockDim.x) to[i] = from[i];
}

}  // namespace evodevo::cuda
