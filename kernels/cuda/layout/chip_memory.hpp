// Where the numbers of a body are in the shared memory of a block.
#pragma once

#include <cstddef>
#include <cstdint>

#include "cuda/layout/arrangement/arrangement.hpp"
#include "cuda/layout/features.hpp"

namespace evodevo::cuda {

/// The largest offset of masses and of entries of the table that a record has room for.
inline constexpr std::size_t largest_offset = 0xffff;

/// The division of a block's shared memory: offsets and size in bytes. It is the same for all blocks of a body.
struct ChipMemory {
  std::size_t table_offset = 0, rate_offset = 0, coefficient_offset = 0, record_offset = 0, wave_offset = 0, size = 0;
  std::uint32_t table_steps = 1;
};

template <class T>
std::size_t group_size(const Features& features) {
  return features.dashpots ? group_bytes<T, true> : group_bytes<T, false>;
}

template <class T>
std::size_t halo_group_size(const Features& features) {
  return features.dashpots ? halo_group_bytes<T, true> : halo_group_bytes<T, false>;
}

/// The size of the masses of a block, which is also the offset of its halo, bytes.
template <class T>
std::size_t bytes_of_groups(std::size_t groups, const Features& features) {
  return (groups + 1) * group_size<T>(features);  // one more group, to which empty slots refer
}

/// The offset of a mass of a block, or of its copy in the halo, bytes.
template <class T>
std::uint32_t offset_in_chip(const Arrangement& arrangement, std::uint32_t index, const Features& features) {
  const std::uint32_t first_of_halo = arrangement.first_of_halo();
  std::size_t group = index / lanes * group_size<T>(features);
  if (index >= first_of_halo)
    group = bytes_of_groups<T>(arrangement.groups, features) +
            (index - first_of_halo) / lanes * halo_group_size<T>(features);
  return static_cast<std::uint32_t>(group + index % lanes * sizeof(T));
}

}  // namespace evodevo::cuda
