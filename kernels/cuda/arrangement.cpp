#include "cuda/arrangement.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "cuda/ownership.hpp"

namespace evodevo::cuda {
namespace {

// few, because each is a kernel to compile
constexpr unsigned unrolled_rows[] = {4, 8, 12, 14, 15, 16, 20, 24};
constexpr unsigned rows_of_a_chunk = 8;
constexpr unsigned resident_warps = 32;  // of a multiprocessor at 64 registers a thread

unsigned divided(std::size_t a, std::size_t b) { return static_cast<unsigned>((a + b - 1) / b); }

/// The shape for `rows` rows that wastes the least: empty rows, and a multiprocessor's room for warps, which hide each
/// other's waiting.
Shape shape_for(std::size_t rows, std::uint32_t groups, unsigned largest_block) {
  Shape best;
  std::size_t best_cost = ~std::size_t{0};
  for (const unsigned unrolled : unrolled_rows) {
    // two masses for each thread where the block may be so large
    const unsigned warps = std::max({1u, divided(rows, unrolled), std::min(divided(groups, 2), largest_block)});
    if (warps > largest_block) continue;
    const unsigned resident = resident_warps / warps * warps;
    const std::size_t cost = std::size_t{unrolled} * warps * (3 * resident_warps - resident);
    if (cost >= best_cost) continue;
    best = {warps, unrolled, 1, 0};
    best_cost = cost;
  }
  if (best.warps == 0) best = {largest_block, rows_of_a_chunk, divided(rows, rows_of_a_chunk * largest_block), 0};
  best.masses_per_thread = std::max(1u, divided(groups, best.warps));
  return best;
}

}  // namespace

std::vector<std::uint32_t> places_by_valence(const Body& body) {
  std::vector<std::uint32_t> valence(body.masses.size()), order(body.masses.size()), place(body.masses.size());
  for (const Spring& spring : body.springs) ++valence[spring.a], ++valence[spring.b];
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return valence[a] > valence[b]; });
  for (std::uint32_t i = 0; i < order.size(); ++i) place[order[i]] = i;
  return place;
}

Arrangement::Arrangement(const Body& body, unsigned largest_block)
    : groups(divided(body.masses.size(), 32)),
      place_of(places_by_valence(body)),
      slot_of(body.springs.size()),
      magic_numbers(32 * groups) {
  const std::vector<std::uint8_t> owned_by_b = choose_owners(body, place_of, groups);
  std::vector<Group> members(groups);
  std::vector<std::uint32_t> owned(32 * groups);
  for (std::uint32_t i = 0; i < body.springs.size(); ++i) {
    std::uint32_t owner = place_of[body.springs[i].a], other = place_of[body.springs[i].b];
    if (owned_by_b[i]) std::swap(owner, other);
    Group& group = members[owner / 32];
    group.links.push_back({static_cast<std::uint8_t>(owner % 32), static_cast<std::uint8_t>(other % 32)});
    group.slots.push_back({i, other});
    group.rows = std::max<std::size_t>(group.rows, ++owned[owner]);
    --magic_numbers[other];
  }
  std::size_t rows = 0;
  for (const Group& group : members) rows += group.rows;
  shape = shape_for(rows, groups, largest_block);
  // rows that are left over stay empty, with the last group that has any
  const auto last = std::find_if(members.rbegin(), members.rend(), [](const Group& g) { return g.rows > 0; });
  if (groups > 0) (last == members.rend() ? members.front() : *last).rows += shape.slots() / 32 - rows;
  lay(members);
  fill_empty_slots();
}

/// Gives every spring its slot and every row its group.
void Arrangement::lay(std::vector<Group>& members) {
  slots.resize(shape.slots());
  turns.assign(std::size_t{shape.warps} * shape.chunks, 0);
  first_group.assign(shape.warps, 0);
  const std::size_t rows_of_warp = std::size_t{shape.chunks} * shape.rows;
  std::size_t row = 0;
  for (std::uint32_t g = 0; g < groups && members[g].rows > 0; ++g) {
    Group& group = members[g];
    choose_rows(group.links, group.rows);
    for (std::size_t i = 0; i < group.links.size(); ++i) {
      const std::size_t slot = 32 * (row + group.links[i].row) + group.links[i].lane;
      slots[slot] = group.slots[i];
      slot_of[group.slots[i].spring] = static_cast<std::uint32_t>(slot);
    }
    for (std::uint32_t lane = 0; lane < 32; ++lane) magic_numbers[32 * g + lane] += static_cast<int>(group.rows);
    const std::size_t end = row + group.rows;
    for (; row < end; ++row)
      if (row % rows_of_warp == 0) first_group[row / rows_of_warp] = g;
    // no warp turns to another group after its last row
    if (end % rows_of_warp != 0) turns[(end - 1) / shape.rows] |= 1u << (end - 1) % shape.rows;
  }
}

/// Empty slots lead to banks that their row leaves free.
void Arrangement::fill_empty_slots() {
  for (std::size_t row = 0; row < slots.size(); row += 32) {
    std::uint32_t busy = 0, bank = 0;
    for (std::size_t lane = 0; lane < 32; ++lane)
      if (slots[row + lane].spring != none) busy |= 1u << slots[row + lane].other % 32;
    for (std::size_t lane = 0; lane < 32; ++lane) {
      if (slots[row + lane].spring != none) continue;
      while (busy >> bank & 1) ++bank;
      slots[row + lane].other = 32 * groups + bank++;
    }
  }
}

double Arrangement::passes_per_row() const {
  std::size_t passes = 0;
  for (std::size_t row = 0; row < slots.size(); row += 32) {
    std::array<std::uint32_t, 32> in_bank{};
    std::uint32_t most = 0;
    for (std::size_t lane = 0; lane < 32; ++lane) most = std::max(most, ++in_bank[slots[row + lane].other % 32]);
    passes += most;
  }
  return slots.empty() ? 0 : 32 * static_cast<double>(passes) / static_cast<double>(slots.size());
}

}  // namespace evodevo::cuda
