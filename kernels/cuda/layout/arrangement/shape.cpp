#include "cuda/layout/arrangement/shape.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "cuda/layout/formats.hpp"

namespace evodevo::cuda {
namespace {

constexpr unsigned blocks[] = {1, 2, 4, 8, 16, 32};  // few values, because each needs a launch of its own
constexpr unsigned resident_warps = 32;              // warps that fit on a multiprocessor, at 64 registers per thread

// cycles in which shared memory is busy with a row, with a row of cut springs, and with the position and the force of
// an owner; shared memory limits the speed
constexpr std::size_t access = 11, cut_access = 8, owner_access = 6;

/// The number of warps in a block of which `warps` have springs: at most two masses per thread, if it may be so large.
unsigned block_for(unsigned warps, std::uint32_t groups, unsigned largest_block) {
  return *std::lower_bound(std::begin(blocks), std::end(blocks),
                           std::max(warps, std::min(divided(groups, 2), largest_block)));
}

/// The number of blocks that a multiprocessor simulates at once, as far as registers and shared memory go, in single
/// precision and without dashpots.
std::size_t blocks_at_once(unsigned block, std::size_t rows, std::uint32_t groups) {
  constexpr std::size_t chip = 227 << 10, others = 3 << 10;  // bytes; others: table, kernel and system
  const std::size_t bytes = rows * lanes * sizeof(Record<float>) + (groups + 1) * group_bytes<float, false> + others;
  return std::max<std::size_t>(1, std::min<std::size_t>(resident_warps / block, chip / bytes));
}

/// Cycles for a step of a body in a block of this shape, if a multiprocessor has as many of them as it has room for.
/// While one block moves its masses and waits for its warps, others compute springs. The numbers of cycles were fitted
/// to measurements of bodies of 64 to 1,000 masses in blocks of different shapes, on an H200.
double full_cost(const Shape& shape, std::size_t room) {
  constexpr double moving = 1000;   // in which a block does not access shared memory for springs
  constexpr double row_time = 100;  // from a warp's row to its next, if no other block is there
  // of a row in which one of the four schedulers has a warp less than others; a block's warps take turns in them
  constexpr double uneven = 4;
  const unsigned missing = shape.block < 4 ? 0 : 4 * divided(shape.warps, 4) - shape.warps;
  const double busy =
      static_cast<double>(access * shape.rows_inside() + owner_access * shape.warps) + uneven * missing * shape.rows;
  const double alone = std::max(busy, row_time * shape.rows) + moving;
  return busy + (alone - busy) / static_cast<double>(room);
}

/// Cycles from one step of a body to the next, if it has a multiprocessor for itself. The numbers of cycles, here and
/// in cost_of(), were fitted to measurements of one to eight bodies of 64 to 250 masses on each multiprocessor of an
/// H100.
double cost_alone(const Shape& shape, std::size_t entries) {
  constexpr double moving = 780, of_warp = 16, row_time = 75, filling = 27;
  return std::max(static_cast<double>(access * shape.rows_inside()), row_time * shape.rows) + moving +
         of_warp * shape.warps + filling * static_cast<double>(entries) / shape.warps;
}

/// Cycles for a step of a body, if each multiprocessor has `target.at_once` of them or as many as it has `room` for.
/// Few bodies wait for their own steps, many for each other; in between, measured times lie where the third norm of
/// both is.
double cost_of(const Shape& shape, std::size_t room, const Target& target) {
  const double full = full_cost(shape, room);
  if (target.at_once >= Target::many) return full;
  constexpr double filling = 4;  // for an entry of the table
  const std::size_t bodies = std::min<std::size_t>(room, target.at_once);
  const double own = cost_alone(shape, target.entries) / static_cast<double>(bodies),
               others = full + filling * static_cast<double>(target.entries);
  return std::cbrt(own * own * own + others * others * others);
}

/// The shape with which a multiprocessor takes the shortest time for a step of a body.
Shape shape_for_block(const Needs& needs, const Target& target) {
  Shape best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (unsigned warps = target.largest_block; warps > 0; --warps) {
    const unsigned rows = std::max(1u, divided(needs.rows, warps));
    if (rows > most_rows) break;
    const Shape shape{block_for(warps, needs.groups, target.largest_block), warps, 0, rows, 0, 1, 0};
    double cost = cost_of(shape, blocks_at_once(shape.block, shape.rows_inside(), needs.groups), target);
    // more rows slow a recording of stress by about 6 %; a body keeps its shape, and half of its steps record stress
    if (rows > rows_with_fast_stress) cost += cost / 32;
    if (cost >= best_cost) continue;
    best = shape;
    best_cost = cost;
  }
  return best;
}

/// The shape for the blocks of a cluster, each of which has a multiprocessor for itself, that takes the shortest time.
/// Either shared memory is busy all the time, or the time is that of the warps with the most rows. Those with cut
/// springs begin late, because they wait for other blocks.
Shape shape_for_cluster(const Needs& needs, unsigned largest_block) {
  constexpr std::size_t row_time = 60, waiting = 700;  // cycles from a warp's row to its next, and until it may begin
  Shape best;
  std::size_t best_cost = ~std::size_t{0};
  for (unsigned warps = largest_block - 1; warps > 0; --warps) {
    const unsigned rows = std::max(1u, divided(needs.rows, warps));
    if (rows > most_rows) break;
    for (unsigned cut_warps = largest_block - warps; cut_warps > 0; --cut_warps) {
      const unsigned cut_rows = divided(needs.cut_rows, cut_warps);
      if (cut_rows > most_rows) break;
      const unsigned block = block_for(warps + cut_warps, needs.groups, largest_block);
      const Shape shape{block, warps, cut_warps, rows, cut_rows, 1, 0};
      const std::size_t busy =
          access * shape.rows_inside() + cut_access * shape.rows_of_cut() + owner_access * (warps + cut_warps);
      const std::size_t longest = std::max(row_time * rows, waiting + row_time * cut_rows);
      const std::size_t cost = 4 * std::max(busy, longest) + busy + longest;
      if (cost >= best_cost) continue;
      best = shape;
      best_cost = cost;
    }
  }
  return best;
}

}  // namespace

Shape shape_for(const Needs& needs, const Target& target) {
  const unsigned largest_block = target.largest_block;
  Shape best = needs.cut_rows > 0 ? shape_for_cluster(needs, largest_block) : shape_for_block(needs, target);
  constexpr unsigned rows = rows_of_a_chunk;
  for (unsigned chunks = divided(needs.rows + needs.cut_rows, rows * largest_block); best.warps == 0; ++chunks) {
    const unsigned cut = divided(needs.cut_rows, rows * chunks);
    if (divided(needs.rows, rows * chunks) + cut <= largest_block)
      best = {largest_block, largest_block - cut, cut, rows, rows, chunks, 0};
  }
  best.masses_per_thread = std::max(1u, divided(needs.groups, best.block));
  return best;
}

}  // namespace evodevo::cuda
