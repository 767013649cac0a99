// The memory of selection operators: lists of whole numbers.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "evodevo/selection.hpp"

namespace evodevo {

/// Returns a list of a memory as whole numbers, such as ids. Throws std::runtime_error if there is no such list, or if
/// a number is not a whole one from 0 to 2^32 - 1.
inline std::vector<std::uint32_t> whole_numbers(const SelectionMemory& memory, const std::string& name) {
  const std::vector<double>& numbers = memory.list(name);
  const auto is_whole = [](double number) {
    return number >= 0 && number <= std::numeric_limits<std::uint32_t>::max() && number == std::floor(number);
  };
  if (!std::all_of(numbers.begin(), numbers.end(), is_whole))
    SelectionMemory::fail("has a number in \"" + name + "\" that is not a whole one from 0 to 2^32 - 1");
  std::vector<std::uint32_t> whole;
  for (const double number : numbers) whole.push_back(static_cast<std::uint32_t>(number));
  return whole;
}

/// Returns whole numbers as a list of a memory.
inline std::vector<double> memory_list(const std::vector<std::uint32_t>& numbers) {
  return {numbers.begin(), numbers.end()};
}

}  // namespace evodevo
