// Which thread computes which spring, and when: the layout of a body on the chip.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "cuda/layout/row_order.hpp"
#include "evodevo/body.hpp"

namespace evodevo::cuda {

/// A place for each mass of `body`: by falling number of springs, so that neighbouring lanes have about as many each.
std::vector<std::uint32_t> indices_by_degree(const Body& body);

/// The sizes that a kernel is compiled for and a body is arranged to.
struct Shape {
  unsigned block = 0;   ///< warps of the block
  unsigned warps = 0;   ///< of them that have springs
  unsigned rows = 0;    ///< springs of a thread in one chunk; unrolled
  unsigned chunks = 0;  ///< of a warp
  unsigned masses_per_thread = 0;

  friend auto operator<=>(const Shape&, const Shape&) = default;
  std::size_t slots() const { return std::size_t{32} * warps * chunks * rows; }
};

/// What an arrangement depends on: how many masses there are, which of them stayed, and which are joined.
struct Outline {
  explicit Outline(const Body& body);
  /// Whether it is that of `body`, but for the rest places.
  bool fits(const Body& body) const;

  std::vector<Vec3> rest;                                     ///< [masses] tells masses that stay from others
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends;  ///< [springs]
};

/// A body's masses and springs in the block's order. Masses lie in groups of 32, one to a lane and a bank of shared
/// memory. A spring is in a row of the group of the mass that owns it, in that mass's lane; all lanes of a row add to
/// different banks as far as possible. The rows of all groups, one after the other, are dealt out evenly to the warps.
/// No result depends on the arrangement but the order in which energies and work are added up.
struct Arrangement {
  static constexpr std::uint32_t none = 0xffffffff;

  /// What lies in one lane of one row.
  struct Slot {
    std::uint32_t spring = none;  ///< index into Body::springs, or none
    std::uint32_t other = 0;      ///< place of the mass at the other end; in an empty slot, one beyond all groups
  };

  /// Arranges `body` for a block of at most `largest_block` warps.
  Arrangement(const Body& body, unsigned largest_block);

  /// Arranges what has become of a body whose outline was `outline` and whose arrangement was `earlier`. Masses and
  /// springs that stay are in the same order as before; most keep their places, owners and rows, which saves most of
  /// the work. Any other body is arranged as well.
  Arrangement(const Body& body, unsigned largest_block, const Arrangement& earlier, const Outline& outline);

  Shape shape;
  std::uint32_t groups = 0;
  std::vector<std::uint32_t> index_of;   ///< [masses] the place of each mass
  std::vector<Slot> slots;               ///< [warps][chunks][rows][32]
  std::vector<std::uint32_t> slot_of;    ///< [springs]
  std::vector<std::uint32_t> first_row;  ///< [groups + 1] the rows of group g are first_row[g] .. first_row[g + 1] - 1
  std::vector<std::uint32_t> first_group;   ///< [block] the group that each warp begins with
  std::vector<std::uint32_t> group_ends;    ///< [block][chunks] bit r: the next group begins after row r
  std::vector<std::int32_t> magic_numbers;  ///< [places] how many a place's force sum has to begin with

  /// The rows of all warps.
  std::size_t rows() const { return slots.size() / 32; }

  /// How many times a warp's access to 32 masses takes, on average; 1 where no two are in one bank.
  double wavefronts_per_row() const;

 private:
  /// What is settled of a body's springs.
  struct Settled {
    std::vector<std::uint32_t> owner;  ///< [springs] the owner's place, or open
    std::vector<std::uint32_t> row;    ///< [springs] of the owner's group, or open
  };
  /// The springs that the masses of each group own, one group behind the other.
  struct Members {
    std::vector<std::size_t> rows;   ///< [groups] that the group needs
    std::vector<std::size_t> first;  ///< [groups + 1] of its springs
    std::vector<Link> links;         ///< [springs]
    std::vector<Slot> slots;         ///< [springs] of each link
  };

  /// [rows] the group that each row belongs to.
  std::vector<std::uint32_t> groups_of_rows() const;
  void arrange(const Body& body, unsigned largest_block, Settled settled);
  Members members_of_groups(const Body& body, const std::vector<std::uint32_t>& owner, const Settled& settled);
  void assign_slots(Members& members);
  void fill_empty_slots();
};

}  // namespace evodevo::cuda
