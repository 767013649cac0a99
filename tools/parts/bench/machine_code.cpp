#include "machine_code.hpp"

#include <elf.h>

#include <cstdint>
#include <cstring>
#include <string_view>

namespace evodevo::tools::bench {
namespace {

template <class T>
T read(const std::vector<char>& file, std::size_t offset) {
  T value;
  static_cast<void>(file.at(offset + sizeof value - 1));
  std::memcpy(&value, &file[offset], sizeof value);
  return value;
}

/// Counts the instructions in a section. An instruction has 16 bytes, whose low twelve bits name the operation.
MachineCode counted(const std::vector<char>& file, const Elf64_Shdr& section) {
  constexpr std::uint16_t operation = 0xfff, no_operation = 0x918, load_local = 0x983, store_local = 0x387;
  MachineCode code;
  for (std::size_t i = 0; i < section.sh_size; i += 16) {
    const auto found = static_cast<std::uint16_t>(read<std::uint16_t>(file, section.sh_offset + i) & operation);
    code.instructions += found != no_operation;
    code.local_accesses += found == load_local || found == store_local;
  }
  return code;
}

}  // namespace

std::map<std::string, MachineCode> machine_code(const std::vector<char>& file) {
  const auto header = read<Elf64_Ehdr>(file, 0);
  const auto section = [&](std::size_t i) { return read<Elf64_Shdr>(file, header.e_shoff + i * header.e_shentsize); };
  const Elf64_Shdr names = section(header.e_shstrndx);
  std::map<std::string, MachineCode> code;
  for (std::size_t i = 0; i < header.e_shnum; ++i) {
    const std::string name = &file.at(names.sh_offset + section(i).sh_name);
    constexpr std::string_view code_of = ".text.";
    if (name.starts_with(code_of)) code[name.substr(code_of.size())] = counted(file, section(i));
  }
  return code;
}

}  // namespace evodevo::tools::bench
