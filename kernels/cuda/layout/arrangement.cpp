#include "cuda/layout/arrangement.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "cuda/layout/ownership.hpp"

namespace evodevo::cuda {
namespace {

// few values, because each pair of them needs a separate launch, and bodies of similar size should share a launch
constexpr unsigned unrolled_rows[] = {4, 8, 12, 15, 16, 20, 24};
constexpr unsigned blocks[] = {1, 2, 4, 8, 16, 32};
constexpr unsigned rows_of_a_chunk = 8;
constexpr unsigned resident_warps = 32;  // warps that fit on a multiprocessor, at 64 registers per thread

unsigned divided(std::size_t a, std::size_t b) { return static_cast<unsigned>((a + b - 1) / b); }

/// The shape for `rows` rows that wastes the least. The choice weighs empty rows against warps for which a
/// multiprocessor has no room, because warps hide each other's waiting times.
Shape shape_for(std::size_t rows, std::uint32_t groups, unsigned largest_block) {
  Shape best;
  std::size_t best_cost = ~std::size_t{0};
  for (const unsigned unrolled : unrolled_rows) {
    const unsigned warps = std::max(1u, divided(rows, unrolled));
    if (warps > largest_block) continue;
    // at most two masses per thread if the block may be that large
    const unsigned block = *std::lower_bound(std::begin(blocks), std::end(blocks),
                                             std::max(warps, std::min(divided(groups, 2), largest_block)));
    const unsigned resident = resident_warps / block * warps;
    const std::size_t cost = std::size_t{unrolled} * warps * (3 * resident_warps - resident);
    if (cost >= best_cost) continue;
    best = {block, warps, unrolled, 1, 0};
    best_cost = cost;
  }
  if (best.warps == 0)
    best = {largest_block, largest_block, rows_of_a_chunk, divided(rows, rows_of_a_chunk * largest_block), 0};
  best.masses_per_thread = std::max(1u, divided(groups, best.block));
  return best;
}

}  // namespace

std::vector<std::uint32_t> indices_by_degree(const Body& body) {
  std::vector<std::uint32_t> degree(body.masses.size()), order(body.masses.size()), index(body.masses.size());
  for (const Spring& spring : body.springs) ++degree[spring.a], ++degree[spring.b];
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return degree[a] > degree[b]; });
  for (std::uint32_t i = 0; i < order.size(); ++i) index[order[i]] = i;
  return index;
}

/// An index below `padded_masses` for each mass of `body`: its earlier index if the mass existed before, otherwise a
/// free index.
std::vector<std::uint32_t> indices_after(const Body& body, std::uint32_t padded_masses,
                                         std::span<const std::uint32_t> earlier_index,
                                         std::span<const Vec3> earlier_rest) {
  std::vector<std::uint32_t> index_of;
  std::vector<bool> taken(padded_masses, false);
  auto next = earlier_rest.begin();
  for (const Mass& mass : body.masses) {
    const auto found = std::find(next, earlier_rest.end(), mass.rest);
    index_of.push_back(
        found == earlier_rest.end() ? open : earlier_index[static_cast<std::size_t>(found - earlier_rest.begin())]);
    if (found != earlier_rest.end()) next = found + 1;
    // if the body has become smaller, the earlier index may be too large
    if (index_of.back() >= padded_masses) index_of.back() = open;
    if (index_of.back() != open) taken[index_of.back()] = true;
  }
  std::uint32_t free = 0;
  for (std::uint32_t& index : index_of) {
    if (index != open) continue;
    while (taken[free]) ++free;
    index = free++;
  }
  return index_of;
}

Outline::Outline(const Body& body) {
  rest.reserve(body.masses.size());
  for (const Mass& mass : body.masses) rest.push_back(mass.rest);
  ends.reserve(body.springs.size());
  for (const Spring& spring : body.springs) ends.emplace_back(spring.a, spring.b);
}

bool Outline::fits(const Body& body) const {
  return body.masses.size() == rest.size() &&
         std::equal(body.springs.begin(), body.springs.end(), ends.begin(), ends.end(),
                    [](const Spring& spring, const auto& pair) { return std::pair(spring.a, spring.b) == pair; });
}

Arrangement::Arrangement(const Body& body, unsigned largest_block)
    : groups(divided(body.masses.size(), 32)), index_of(indices_by_degree(body)) {
  const std::vector<std::uint32_t> all_open(body.springs.size(), open);
  arrange(body, largest_block, {all_open, all_open});
}

Arrangement::Arrangement(const Body& body, unsigned largest_block, const Arrangement& earlier, const Outline& outline)
    : groups(divided(body.masses.size(), 32)),
      index_of(indices_after(body, 32 * groups, earlier.index_of, outline.rest)) {
  Settled settled;
  settled.owner.reserve(body.springs.size());
  settled.row.reserve(body.springs.size());
  const std::vector<std::uint32_t> group_of_row = earlier.groups_of_rows();
  auto next = outline.ends.begin();
  for (const Spring& spring : body.springs) {
    const std::uint32_t a = index_of[spring.a], b = index_of[spring.b];
    const auto found = std::find_if(next, outline.ends.end(), [&](const auto& ends) {
      const std::uint32_t c = earlier.index_of[ends.first], d = earlier.index_of[ends.second];
      // without branches, because the processor could not predict them
      return ((c == a) & (d == b)) | ((d == a) & (c == b));
    });
    if (found == outline.ends.end()) {
      settled.owner.push_back(open);
      settled.row.push_back(open);
      continue;
    }
    next = found + 1;
    const std::uint32_t slot = earlier.slot_of[static_cast<std::size_t>(found - outline.ends.begin())];
    const std::uint32_t group = group_of_row[slot / 32];
    settled.owner.push_back(32 * group + slot % 32);
    settled.row.push_back(slot / 32 - earlier.first_row[group]);
  }
  arrange(body, largest_block, std::move(settled));
}

std::vector<std::uint32_t> Arrangement::groups_of_rows() const {
  std::vector<std::uint32_t> group(rows());
  for (std::uint32_t g = 0; g < groups; ++g)
    std::fill(group.begin() + first_row[g], group.begin() + first_row[g + 1], g);
  return group;
}

void Arrangement::arrange(const Body& body, unsigned largest_block, Settled settled) {
  std::vector<std::uint32_t> owner = settled.owner;
  choose_owners(body, index_of, groups, owner);
  Members members = members_of_groups(body, owner, settled);
  const std::size_t needed = std::accumulate(members.rows.begin(), members.rows.end(), std::size_t{0});
  shape = shape_for(needed, groups, largest_block);
  // rows beyond those needed stay empty; they belong to the last group that has rows
  const auto last = std::find_if(members.rows.rbegin(), members.rows.rend(), [](std::size_t rows) { return rows > 0; });
  if (groups > 0) (last == members.rows.rend() ? members.rows.front() : *last) += shape.slots() / 32 - needed;
  assign_slots(members);
  fill_empty_slots();
}

/// Sorts the springs by the group of their owner, and counts the springs that lead to each mass, for magic_numbers.
Arrangement::Members Arrangement::members_of_groups(const Body& body, const std::vector<std::uint32_t>& owner,
                                                    const Settled& settled) {
  std::vector<std::uint32_t> owned(32 * groups, 0);
  for (const std::uint32_t index : owner) ++owned[index];
  Members members{.rows = std::vector<std::size_t>(groups),
                  .first = std::vector<std::size_t>(groups + 1),
                  .links = std::vector<Link>(owner.size()),
                  .slots = std::vector<Slot>(owner.size())};
  for (std::uint32_t g = 0; g < groups; ++g) {
    const auto begin = owned.begin() + 32 * g, end = begin + 32;
    members.rows[g] = *std::max_element(begin, end);
    members.first[g + 1] = members.first[g] + std::accumulate(begin, end, std::size_t{0});
  }
  magic_numbers.assign(32 * groups, 0);
  std::vector<std::size_t> next = members.first;
  for (std::uint32_t i = 0; i < owner.size(); ++i) {
    const std::uint32_t other = index_of[body.springs[i].a] + index_of[body.springs[i].b] - owner[i];
    const std::size_t at = next[owner[i] / 32]++;
    members.links[at] = {static_cast<std::uint8_t>(owner[i] % 32), static_cast<std::uint8_t>(other % 32),
                         owner[i] == settled.owner[i] ? settled.row[i] : open};
    members.slots[at] = {i, other};
    --magic_numbers[other];
  }
  return members;
}

/// Gives every spring its slot and every row its group, and marks where groups end.
void Arrangement::assign_slots(Members& members) {
  slots.resize(shape.slots());
  slot_of.resize(members.slots.size());
  group_ends.assign(std::size_t{shape.block} * shape.chunks, 0);
  first_group.assign(shape.block, 0);
  first_row.assign(groups + 1, static_cast<std::uint32_t>(rows()));
  const std::size_t rows_of_warp = std::size_t{shape.chunks} * shape.rows;
  std::size_t row = 0;
  for (std::uint32_t g = 0; g < groups && members.rows[g] > 0; ++g) {
    first_row[g] = static_cast<std::uint32_t>(row);
    const std::size_t first = members.first[g], count = members.first[g + 1] - first;
    choose_rows(std::span(members.links).subspan(first, count), members.rows[g]);
    for (std::size_t i = first; i < first + count; ++i) {
      const std::size_t slot = 32 * (row + members.links[i].row) + members.links[i].lane;
      slots[slot] = members.slots[i];
      slot_of[members.slots[i].spring] = static_cast<std::uint32_t>(slot);
    }
    const auto rows_of_group = static_cast<std::int32_t>(members.rows[g]);
    for (std::uint32_t lane = 0; lane < 32; ++lane) magic_numbers[32 * g + lane] += rows_of_group;
    const std::size_t end = row + members.rows[g];
    for (; row < end; ++row)
      if (row % rows_of_warp == 0) first_group[row / rows_of_warp] = g;
    // a warp's last row is never marked, because no row of the warp follows it
    if (end % rows_of_warp != 0) group_ends[(end - 1) / shape.rows] |= 1u << (end - 1) % shape.rows;
  }
}

/// Gives empty slots a mass to write to, in a bank that the row does not use otherwise.
void Arrangement::fill_empty_slots() {
  for (auto row = slots.begin(); row != slots.end(); row += 32) {
    if (std::none_of(row, row + 32, [](const Slot& slot) { return slot.spring == none; })) continue;
    std::uint32_t busy = 0, bank = 0;
    for (auto slot = row; slot != row + 32; ++slot)
      if (slot->spring != none) busy |= 1u << slot->other % 32;
    for (auto slot = row; slot != row + 32; ++slot) {
      if (slot->spring != none) continue;
      while (busy >> bank & 1) ++bank;
      slot->other = 32 * groups + bank++;
    }
  }
}

double Arrangement::wavefronts_per_row() const {
  std::size_t wavefronts = 0;
  for (std::size_t row = 0; row < slots.size(); row += 32) {
    std::array<std::uint32_t, 32> in_bank{};
    std::uint32_t most = 0;
    for (std::size_t lane = 0; lane < 32; ++lane) most = std::max(most, ++in_bank[slots[row + lane].other % 32]);
    wavefronts += most;
  }
  return slots.empty() ? 0 : 32 * static_cast<double>(wavefronts) / static_cast<double>(slots.size());
}

}  // namespace evodevo::cuda
