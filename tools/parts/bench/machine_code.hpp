// What the machine code of a kernel says of itself.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace evodevo::tools::bench {

struct MachineCode {
  std::size_t instructions = 0;    ///< without those that only pad
  std::size_t local_accesses = 0;  ///< those that access local memory, where registers go that do not suffice
};

/// Reads a file of machine code (cubin) for an NVIDIA GPU of Volta or later, as cuda::compile() returns it, and returns
/// what it holds of each kernel, by name. Throws std::out_of_range if the file is cut off.
std::map<std::string, MachineCode> machine_code(const std::vector<char>& file);

}  // namespace evodevo::tools::bench
