// What the edits of devo operators hold, as lists of numbers.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "evodevo/devo.hpp"

namespace evodevo::testing {

/// The indices of removed masses or springs.
inline std::vector<std::uint32_t> indices(const std::vector<Removal>& removals) {
  std::vector<std::uint32_t> all;
  for (const Removal& removal : removals) all.push_back(removal.index);
  return all;
}

/// The causes of the edits of a kind, but for those that have none.
template <class Edit>
std::vector<double> causes(const std::vector<Edit>& edits) {
  std::vector<double> all;
  for (const Edit& edit : edits)
    if (!std::isnan(edit.cause)) all.push_back(edit.cause);
  return all;
}

/// The causes of all edits.
inline std::vector<double> all_causes(const Edits& edits) {
  std::vector<double> all;
  for (const std::vector<double>& of_kind :
       {causes(edits.removed_springs), causes(edits.removed_masses), causes(edits.changed_springs),
        causes(edits.new_masses), causes(edits.new_springs)})
    all.insert(all.end(), of_kind.begin(), of_kind.end());
  return all;
}

/// The values that an operator remembers from now on about all masses, or about all springs, in the order of their
/// indices. Expects that it has set those of each, once.
inline std::vector<double> remembered(const MemoryEdits& memory) {
  std::vector<std::uint32_t> items = memory.items, expected(items.size());
  std::ranges::sort(items);
  std::iota(expected.begin(), expected.end(), 0u);
  EXPECT_EQ(items, expected);
  std::vector<double> values;
  for (const std::uint32_t item : items) {
    const auto at = std::ranges::find(memory.items, item) - memory.items.begin();
    const auto first = memory.values.begin() + static_cast<std::ptrdiff_t>(std::accumulate(
                                                   memory.counts.begin(), memory.counts.begin() + at, std::size_t{0}));
    values.insert(values.end(), first,
                  first + static_cast<std::ptrdiff_t>(memory.counts[static_cast<std::size_t>(at)]));
  }
  return values;
}

/// Edits of a body that remove springs and masses.
inline Edits removing(const Body& body, const std::vector<std::uint32_t>& springs,
                      const std::vector<std::uint32_t>& masses = {}) {
  Edits edits(body);
  for (const std::uint32_t goes : springs) edits.remove_spring(goes);
  for (const std::uint32_t goes : masses) edits.remove_mass(goes);
  return edits;
}

/// Edits of a body that change springs, such as `{.spring = 2, .rest_length = 1}`.
inline Edits changing(const Body& body, const std::vector<ChangedSpring>& changes) {
  Edits edits(body);
  for (const ChangedSpring& change : changes) edits.change_spring(change.spring, change);
  return edits;
}

}  // namespace evodevo::testing
