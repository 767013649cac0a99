// Materials from a table in shared memory: stiffness and length of each of the body's materials in each of the next
// steps.
#pragma once

#include "cuda/device/resident.cuh"

namespace evodevo::cuda {

constexpr unsigned entry_shift = EVODEVO_ENTRY_SHIFT;  // left shift that turns offsets of entries into bytes

/// The records of the springs, beginning with a given spring.
struct Records {
  using Read = Record<Number>;
  const Record<Number>* first;

  __device__ __forceinline__ Read operator[](unsigned i) const { return first[i]; }
  __device__ __forceinline__ Records from(unsigned slot) const { return {first + slot}; }

  static __device__ __forceinline__ Records of(const Body& body) {
    return {array_of(body.records, body.record_offset)};
  }
  /// Copies what belongs on the chip. `count`: number of records.
  static __device__ __forceinline__ void load(const Body& body, unsigned count) {
    if constexpr (dashpots) copy_to_chip(body.coefficients, body.coefficient_offset, body.entries);
    if constexpr (records_on_chip) copy_to_chip(body.records, body.record_offset, count);
  }
};

/// A spring's material in a pass.
struct SpringMaterial {
  unsigned table_entry;  // offset from the table's beginning
  Entry<Number> entry;
};

/// The offsets in shared memory of the lengths of a pass and of their rates of change.
struct Lengths {
  unsigned table;
  unsigned rates = 0;
  unsigned coefficients = 0;  // of the dashpots

  __device__ __forceinline__ explicit Lengths(const Body& body) : table(body.table_offset) {
    if constexpr (work) rates = body.rate_offset;
    if constexpr (dashpots) coefficients = body.coefficient_offset;
  }

  __device__ __forceinline__ SpringMaterial operator()(const Records::Read& record) const {
    const unsigned offset = (static_cast<unsigned>(record.packed) >> 16) << entry_shift;
    return {offset, on_chip<Entry<Number>>(table + offset)};
  }

  /// The rate of change of L/L0, 1/s.
  template <class T>
  __device__ __forceinline__ Number rate_of(const T& material) const {
    static_assert(only_for<work, T>);
    return on_chip<Number>(rates + material.table_entry / 2);
  }

  /// The coefficient of the dashpots, units of force s/m.
  template <class T>
  __device__ __forceinline__ Number damping_of(const T& material) const {
    static_assert(only_for<dashpots, T>);
    return on_chip<Number>(coefficients + material.table_entry / 2);
  }

  __device__ __forceinline__ void advance_rows(const Body& body, unsigned rows_on) {
    const unsigned row_bytes = body.entries * sizeof(Entry<Number>);
    table += rows_on * row_bytes;
    if constexpr (work) rates += rows_on * row_bytes / 2;
  }
};

/// Fills `count` rows of the table, beginning with step `step` of the piece.
__device__ __noinline__ void fill_lengths(const Body& body, std::uint64_t step, unsigned count) {
  const double interval = body.constants.exact_dt / rows_per_step;
  const std::uint64_t row = (body.piece.first_step + step) * rows_per_step;
  for (unsigned i = threadIdx.x; i < count * body.entries; i += blockDim.x) {
    const Actuator actuator = body.actuators[i % body.entries];
    const double time = body.piece.origin + static_cast<double>(row + i / body.entries) * interval;
    on_chip<Entry<Number>>(body.table_offset + i * sizeof(Entry<Number>)) = entry_of(actuator, time);
    if constexpr (work) on_chip<Number>(body.rate_offset + i * sizeof(Number)) = length_rate(actuator, time);
  }
}

}  // namespace evodevo::cuda
