// The arrangement of a body on the chip: which thread computes which spring, and when.
//
//   body ─► choose_owners (ownership.hpp) ─► shape ─► choose_rows (row_order.hpp) ─► slots
//
// kernels/cuda/README.md explains the terms.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "cuda/layout/row_order.hpp"
#include "evodevo/body.hpp"

namespace evodevo::cuda {

/// The device index of each mass of `body`: masses are sorted by descending degree (number of springs), so that masses
/// in neighbouring lanes have similar numbers of springs.
std::vector<std::uint32_t> indices_by_degree(const Body& body);

/// The sizes of a block for which a kernel is compiled and a body is arranged.
struct Shape {
  unsigned block = 0;   ///< warps in the block
  unsigned warps = 0;   ///< warps that have springs
  unsigned rows = 0;    ///< rows in a chunk: springs of one thread in an unrolled loop
  unsigned chunks = 0;  ///< chunks of rows for each warp
  unsigned masses_per_thread = 0;

  friend auto operator<=>(const Shape&, const Shape&) = default;
  std::size_t slots() const { return std::size_t{32} * warps * chunks * rows; }
};

/// The properties of a body on which an arrangement depends: its masses, and the pairs of masses that springs join.
struct Outline {
  explicit Outline(const Body& body);
  /// Whether this is the outline of `body`, except for rest positions.
  bool fits(const Body& body) const;

  std::vector<Vec3> rest;  ///< [masses] rest positions, by which masses are recognised later
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends;  ///< [springs]
};

/// A body's masses and springs in the order of a thread block.
///
/// Masses are in groups of 32: each mass of a group has its own lane of a warp and its own bank of shared memory. A
/// spring is in a row of the group of the mass that owns it, in the lane of that mass; the lanes of a row add forces to
/// different banks as far as possible. The rows of all groups, one group after the other, are divided evenly among the
/// warps. The arrangement influences only the order in which energies and work are summed, and nothing else.
struct Arrangement {
  static constexpr std::uint32_t none = 0xffffffff;

  /// One lane of one row: a spring, or empty.
  struct Slot {
    std::uint32_t spring = none;  ///< index into Body::springs, or none
    std::uint32_t other = 0;      ///< index of the mass at the other end; in an empty slot, an index beyond all groups
  };

  /// Arranges `body` for a block of at most `largest_block` warps.
  Arrangement(const Body& body, unsigned largest_block);

  /// Arranges a body that has developed from one with the outline `outline` and the arrangement `earlier`. If the
  /// remaining masses and springs are in the same order as before, most keep their indices, owners and rows, which
  /// saves most of the work. Any other body is arranged correctly as well.
  Arrangement(const Body& body, unsigned largest_block, const Arrangement& earlier, const Outline& outline);

  Shape shape;
  std::uint32_t groups = 0;
  std::vector<std::uint32_t> index_of;   ///< [masses] the device index of each mass
  std::vector<Slot> slots;               ///< [warps][chunks][rows][32]
  std::vector<std::uint32_t> slot_of;    ///< [springs] index into `slots`
  std::vector<std::uint32_t> first_row;  ///< [groups + 1] the rows of group g are first_row[g] .. first_row[g + 1] - 1
  std::vector<std::uint32_t> first_group;  ///< [block] the group that each warp begins with
  std::vector<std::uint32_t> group_ends;   ///< [block][chunks] bit r: the next group begins after row r
  std::vector<std::int32_t>
      magic_numbers;  ///< [padded masses] number of magic numbers with which a mass's force sum begins

  /// The number of rows of all warps.
  std::size_t rows() const { return slots.size() / 32; }

  /// The average number of wavefronts that an access of a warp to 32 masses takes: 1 if no two masses are in the same
  /// bank.
  double wavefronts_per_row() const;

 private:
  /// Owners and rows of a body's springs as far as they are already chosen.
  struct Settled {
    std::vector<std::uint32_t> owner;  ///< [springs] the owner's index, or open
    std::vector<std::uint32_t> row;    ///< [springs] the row in the owner's group, or open
  };
  /// The springs, sorted by the group whose masses own them.
  struct Members {
    std::vector<std::size_t> rows;   ///< [groups] number of rows that the group needs
    std::vector<std::size_t> first;  ///< [groups + 1] index of the group's first spring
    std::vector<Link> links;         ///< [springs]
    std::vector<Slot> slots;         ///< [springs] the content of each spring's slot
  };

  /// The group of each row.
  std::vector<std::uint32_t> groups_of_rows() const;
  void arrange(const Body& body, unsigned largest_block, Settled settled);
  Members members_of_groups(const Body& body, const std::vector<std::uint32_t>& owner, const Settled& settled);
  void assign_slots(Members& members);
  void fill_empty_slots();
};

}  // namespace evodevo::cuda
