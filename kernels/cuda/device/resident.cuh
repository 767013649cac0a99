// What resident.cu and the ways to know its springs' materials (materials/) share: the form of the body and the chip's
// memory.
#pragma once

#include "cuda/device/check.cuh"

namespace evodevo::cuda {

constexpr unsigned rows = EVODEVO_ROWS;                    // springs of a thread in one chunk, unrolled
constexpr unsigned masses_per_thread = EVODEVO_MASSES;     // that a thread moves
constexpr bool chunked = EVODEVO_CHUNKED;                  // more rows for each warp than can be unrolled
constexpr bool records_on_chip = EVODEVO_RECORDS_ON_CHIP;  // else they are streamed from memory
constexpr unsigned offset_shift = EVODEVO_OFFSET_SHIFT;    // what offsets of masses are shifted by
using Body = ResidentBody<Number>;

extern __shared__ __align__(16) unsigned char chip[];

template <class T>
__device__ __forceinline__ T& on_chip(unsigned offset) {
  return *reinterpret_cast<T*>(chip + offset);
}

/// A pointer to the device's memory, said to the compiler, which otherwise cannot know that it is not to shared memory.
template <class T>
__device__ __forceinline__ T* in_memory(T* pointer) {
  __builtin_assume(__isGlobal(pointer));
  return pointer;
}

/// Where an array of a body lies that is brought onto the chip where there is room.
template <class T>
__device__ __forceinline__ const T* array_of(const T* in_device, unsigned offset) {
  return records_on_chip ? &on_chip<T>(offset) : in_memory(in_device);
}

/// Brings such an array onto the chip.
template <class T>
__device__ __forceinline__ void copy_to_chip(const T* from, unsigned offset, unsigned count) {
  T* to = &on_chip<T>(offset);
  for (unsigned i = threadIdx.x; i < count; i += blockDim.x) to[i] = from[i];
}

}  // namespace evodevo::cuda
