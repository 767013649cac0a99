#include "cuda/layout/arrangement/arrangement.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <functional>
#include <numeric>

#include "cuda/layout/arrangement/ownership.hpp"
#include "cuda/layout/formats.hpp"

namespace evodevo::cuda {
std::vector<std::uint32_t> indices_by_degree(const Outline& outline) {
  struct Degree {
    std::uint32_t cut = 0, inside = 0;
    auto operator<=>(const Degree&) const = default;
  };
  std::vector<Degree> degree(outline.rest.size());
  std::vector<std::uint32_t> order(degree.size()), index(degree.size());
  for (const auto& [a, b] : outline.ends) ++degree[a].inside, ++degree[b].inside;
  for (const auto& [mass, other] : outline.cut) ++degree[mass].cut;
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return degree[a] > degree[b]; });
  for (std::uint32_t i = 0; i < order.size(); ++i) index[order[i]] = i;
  return index;
}

/// An index below `padded_masses` for each mass with rest position `rest`: its earlier index if the mass existed
/// before, otherwise a free index.
std::vector<std::uint32_t> indices_after(std::span<const Vec3> rest, std::uint32_t padded_masses,
                                         std::span<const std::uint32_t> earlier_index,
                                         std::span<const Vec3> earlier_rest) {
  std::vector<std::uint32_t> index_of;
  std::vector<bool> taken(padded_masses, false);
  auto next = earlier_rest.begin();
  for (const Vec3& place : rest) {
    const auto found = std::find(next, earlier_rest.end(), place);
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

Arrangement::Arrangement(const Outline& outline)
    : groups(divided(outline.rest.size(), 32)), index_of(indices_by_degree(outline)) {}

Arrangement::Arrangement(const Outline& outline, const Target& target) : Arrangement(outline) {
  const std::vector<std::uint32_t> all_open(outline.ends.size(), open);
  Draft all = draft(outline, {all_open, all_open});
  const Shape best = shape_for(all.needs, target);
  fit(std::move(all), best);
}

std::vector<Arrangement> Arrangement::of_parts(std::span<const Outline* const> parts, const Target& target) {
  std::vector<Arrangement> arrangements;
  std::vector<Draft> drafts;
  Needs most;
  for (const Outline* part : parts) {
    const std::vector<std::uint32_t> all_open(part->ends.size(), open);
    arrangements.push_back(Arrangement(*part));
    drafts.push_back(arrangements.back().draft(*part, {all_open, all_open}));
    const Needs& needs = drafts.back().needs;
    most = {std::max(most.rows, needs.rows), std::max(most.cut_rows, needs.cut_rows),
            std::max(most.groups, needs.groups)};
  }
  const Shape shape = shape_for(most, target);
  for (std::size_t i = 0; i < drafts.size(); ++i) arrangements[i].fit(std::move(drafts[i]), shape);
  return arrangements;
}

Arrangement::Arrangement(const Outline& outline, const Target& target, const Arrangement& earlier,
                         const Outline& before)
    : groups(divided(outline.rest.size(), 32)),
      index_of(indices_after(outline.rest, 32 * groups, earlier.index_of, before.rest)) {
  Settled settled;
  settled.owner.reserve(outline.ends.size());
  settled.row.reserve(outline.ends.size());
  const std::vector<std::uint32_t> group_of_row = earlier.groups_of_rows();
  auto next = before.ends.begin();
  for (const auto& [first, second] : outline.ends) {
    const std::uint32_t a = index_of[first], b = index_of[second];
    const auto found = std::find_if(next, before.ends.end(), [&](const auto& ends) {
      const std::uint32_t c = earlier.index_of[ends.first], d = earlier.index_of[ends.second];
      // without branches, because the processor could not predict them
      return ((c == a) & (d == b)) | ((d == a) & (c == b));
    });
    if (found == before.ends.end()) {
      settled.owner.push_back(open);
      settled.row.push_back(open);
      continue;
    }
    next = found + 1;
    const std::uint32_t slot = earlier.slot_of[static_cast<std::size_t>(found - before.ends.begin())];
    const std::uint32_t group = group_of_row[slot / 32];
    settled.owner.push_back(32 * group + slot % 32);
    settled.row.push_back(slot / 32 - earlier.first_row[group]);
  }
  Draft all = draft(outline, settled);
  const Shape best = shape_for(all.needs, target);
  fit(std::move(all), best);
}

std::vector<std::uint32_t> Arrangement::groups_of_rows() const {
  std::vector<std::uint32_t> group(rows());
  for (std::uint32_t g = 0; g < groups; ++g)
    std::fill(group.begin() + first_row[g], group.begin() + first_row[g + 1], g);
  return group;
}

Arrangement::Draft Arrangement::draft(const Outline& outline, const Settled& settled) {
  magic_numbers.assign(32 * groups, 0);
  number_halo(outline);
  Draft draft{members_inside(outline, settled), members_cut(outline), {}};
  draft.needs = {draft.inside.all_rows(), draft.cut.all_rows(), groups};
  return draft;
}

void Arrangement::fit(Draft draft, const Shape& into) {
  shape = into;
  // empty slots of cut springs read from the halo, also where no spring is cut
  if (shape.cut_warps > 0) halo_groups = std::max(halo_groups, 1u);
  auto& [inside, cut, needs] = draft;
  inside.fill_up(shape.rows_inside());
  cut.fill_up(shape.rows_of_cut());
  slots.resize(shape.slots());
  slot_of.resize(inside.slots.size() + cut.slots.size());
  group_ends.assign(std::size_t{shape.block} * shape.chunks, 0);
  first_group.assign(shape.block, 0);
  first_row = assign_slots(inside, 0, 0, shape.rows);
  if (shape.cut_warps > 0) assign_slots(cut, shape.rows_inside(), shape.warps, shape.cut_rows);
  fill_empty_slots();
}

/// Gives the masses of the halo their banks, so that the springs of each group are spread over the banks: first those
/// to which most springs lead.
void Arrangement::number_halo(const Outline& outline) {
  halo_masses = outline.halo;
  halo_groups = divided(halo_masses, 32);
  std::vector<std::vector<std::uint32_t>> users(outline.halo);  // the group of each spring that leads there
  for (const auto& [mass, other] : outline.cut) users[other].push_back(index_of[mass] / 32);
  std::vector<std::uint32_t> order(outline.halo);
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, std::greater(), [&](std::uint32_t other) { return users[other].size(); });
  using Banks = std::array<std::uint32_t, 32>;
  std::vector<Banks> springs(groups);  // number of each group's springs in each bank
  Banks used{};                        // masses in each bank
  const std::size_t first = index_of.size();
  index_of.resize(first + outline.halo);
  for (const std::uint32_t other : order) {
    Banks cost{};
    for (const std::uint32_t group : users[other])
      for (std::size_t bank = 0; bank < 32; ++bank) cost[bank] += springs[group][bank];
    std::size_t best = 32;
    for (std::size_t bank = 0; bank < 32; ++bank)
      if (used[bank] < halo_groups && (best == 32 || cost[bank] < cost[best])) best = bank;
    for (const std::uint32_t group : users[other]) ++springs[group][best];
    index_of[first + other] = first_of_halo() + 32 * used[best]++ + static_cast<std::uint32_t>(best);
  }
}

std::size_t Arrangement::Members::all_rows() const { return std::accumulate(rows.begin(), rows.end(), std::size_t{0}); }

void Arrangement::Members::fill_up(std::size_t to) {
  if (rows.empty() || to == 0) return;
  const std::size_t needed = all_rows();
  const auto last = std::find_if(rows.rbegin(), rows.rend(), [](std::size_t of_group) { return of_group > 0; });
  (last == rows.rend() ? rows.front() : *last) += to - needed;
}

/// The springs inside, after their owners have been chosen. Counts those that lead to each mass, for magic_numbers.
Arrangement::Members Arrangement::members_inside(const Outline& outline, const Settled& settled) {
  std::vector<std::uint32_t> owner = settled.owner;
  choose_owners(outline, index_of, groups, owner);
  Members members = members_of_groups(owner);
  std::vector<std::size_t> next = members.first;
  for (std::uint32_t i = 0; i < owner.size(); ++i) {
    const std::uint32_t other = index_of[outline.ends[i].first] + index_of[outline.ends[i].second] - owner[i];
    const std::size_t at = next[owner[i] / 32]++;
    members.links[at] = {static_cast<std::uint8_t>(owner[i] % 32), static_cast<std::uint8_t>(other % 32),
                         owner[i] == settled.owner[i] ? settled.row[i] : open};
    members.slots[at] = {i, other};
    --magic_numbers[other];
  }
  return members;
}

Arrangement::Members Arrangement::members_cut(const Outline& outline) const {
  std::vector<std::uint32_t> owner;
  owner.reserve(outline.cut.size());
  for (const auto& [mass, other] : outline.cut) owner.push_back(index_of[mass]);
  Members members = members_of_groups(owner);
  std::vector<std::size_t> next = members.first;
  for (std::uint32_t i = 0; i < owner.size(); ++i) {
    const std::uint32_t other = index_of[outline.rest.size() + outline.cut[i].second];
    const std::size_t at = next[owner[i] / 32]++;
    members.links[at] = {static_cast<std::uint8_t>(owner[i] % 32), static_cast<std::uint8_t>(other % 32)};
    members.slots[at] = {static_cast<std::uint32_t>(outline.ends.size()) + i, other};
  }
  return members;
}

/// The room for springs with these owners.
Arrangement::Members Arrangement::members_of_groups(std::span<const std::uint32_t> owner) const {
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
  // a warp goes from each group to the next, so a group without springs needs a row if one with springs follows
  bool has_later = false;
  for (std::uint32_t g = groups; g-- > 0;) {
    if (has_later) members.rows[g] = std::max<std::size_t>(members.rows[g], 1);
    has_later = has_later || members.rows[g] > 0;
  }
  return members;
}

/// Gives every spring its slot and every row its group, from row `first_row_of_all` and warp `first_warp` on, and marks
/// where groups and the work of warps end. A chunk has `rows` rows. Returns [groups + 1] the first row of each group.
std::vector<std::uint32_t> Arrangement::assign_slots(Members& members, std::size_t first_row_of_all,
                                                     unsigned first_warp, unsigned rows) {
  const std::size_t rows_of_warp = std::size_t{shape.chunks} * rows;
  std::uint32_t* const ends = group_ends.data() + std::size_t{first_warp} * shape.chunks;
  const auto mark_end = [&](std::size_t row) {
    const std::size_t of_kind = row - first_row_of_all;
    ends[of_kind / rows] |= 1u << of_kind % rows;
  };
  std::vector<std::uint32_t> first_rows;
  std::size_t row = first_row_of_all;
  for (std::uint32_t g = 0; g < groups; ++g) {
    first_rows.push_back(static_cast<std::uint32_t>(row));
    if (members.rows[g] == 0) continue;
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
      if ((row - first_row_of_all) % rows_of_warp == 0)
        first_group[first_warp + (row - first_row_of_all) / rows_of_warp] = g;
    mark_end(end - 1);
  }
  for (std::size_t end = first_row_of_all + rows_of_warp; end <= row; end += rows_of_warp) mark_end(end - 1);
  first_rows.push_back(static_cast<std::uint32_t>(row));
  return first_rows;
}

/// Gives empty slots a mass to write to, in a bank that the row does not use otherwise. Those of cut springs only read
/// from the halo.
void Arrangement::fill_empty_slots() {
  const auto first_cut = slots.begin() + static_cast<std::ptrdiff_t>(32 * shape.rows_inside());
  for (auto row = slots.begin(); row != slots.end(); row += 32) {
    std::uint32_t empty = 0, busy = 0, bank = 0;
    for (std::uint32_t lane = 0; lane < 32; ++lane) {  // without branches, because empty slots are hard to predict
      const std::uint32_t is_empty = row[lane].spring == none;
      empty |= is_empty << lane;
      busy |= (is_empty ^ 1) << row[lane].other % 32;
    }
    const std::uint32_t first = row < first_cut ? 32 * groups : first_of_halo();
    for (; empty != 0; empty &= empty - 1) {
      while (busy >> bank & 1) ++bank;
      row[std::countr_zero(empty)].other = first + bank++;
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
