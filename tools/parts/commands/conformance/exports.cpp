#include "conformance/exports.hpp"

#include <elf.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string_view>

namespace evodevo::conformance {
namespace {

/// The bytes of a file. Every access is checked, because the file may have any content.
class Bytes {
 public:
  explicit Bytes(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(stream), {});
  }

  template <class T>
  T at(std::size_t offset) const {
    T value;
    if (offset > bytes_.size() || bytes_.size() - offset < sizeof value)
      throw std::runtime_error("the library is truncated");
    std::memcpy(&value, bytes_.data() + offset, sizeof value);
    return value;
  }

  std::string text(std::size_t offset) const {
    if (offset >= bytes_.size()) throw std::runtime_error("the library is truncated");
    const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(offset);
    return {begin, std::find(begin, bytes_.end(), '\0')};
  }

 private:
  std::vector<char> bytes_;
};

bool is_export(const Elf64_Sym& symbol) {
  const auto visibility = ELF64_ST_VISIBILITY(symbol.st_other);
  return symbol.st_shndx != SHN_UNDEF && symbol.st_shndx != SHN_ABS && ELF64_ST_BIND(symbol.st_info) != STB_LOCAL &&
         (visibility == STV_DEFAULT || visibility == STV_PROTECTED);
}

/// Returns whether a mangled name (Itanium C++ ABI, 5.1) belongs to an instance of a template of the standard library.
/// Such symbols are exported regardless of the visibility that the compiler was told to use.
bool is_of_standard_library(std::string_view name) {
  const auto skip = [&name](std::string_view prefix) {
    const bool found = name.starts_with(prefix);
    if (found) name.remove_prefix(prefix.size());
    return found;
  };
  if (!skip("_Z")) return false;
  if (!skip("GV") && name.size() > 1 && name[0] == 'T' && name[1] >= 'A' && name[1] <= 'Z') name.remove_prefix(2);
  skip("Z");
  skip("N");
  while (skip("V") || skip("K")) continue;
  return skip("9__gnu_cxx") || (skip("S") && name.find_first_of("abdiost") == 0);
}

}  // namespace

std::vector<std::string> exports(const std::filesystem::path& library) {
  const Bytes file(library);
  const auto header = file.at<Elf64_Ehdr>(0);
  const auto section = [&](std::size_t i) { return file.at<Elf64_Shdr>(header.e_shoff + i * header.e_shentsize); };
  std::vector<std::string> names;
  for (std::size_t i = 0; i < header.e_shnum; ++i) {
    const Elf64_Shdr table = section(i);
    if (table.sh_type != SHT_DYNSYM) continue;
    const Elf64_Shdr strings = section(table.sh_link);
    for (std::size_t offset = 0; offset + sizeof(Elf64_Sym) <= table.sh_size; offset += sizeof(Elf64_Sym)) {
      const auto symbol = file.at<Elf64_Sym>(table.sh_offset + offset);
      if (!is_export(symbol)) continue;
      std::string name = file.text(strings.sh_offset + symbol.st_name);
      if (!is_of_standard_library(name)) names.push_back(std::move(name));
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace evodevo::conformance
