// The arrangement of a body on the chip: which thread computes which spring, and when.
//
//   outline ─► choose_owners (ownership.hpp) ─► shape_for (shape.hpp) ─► choose_rows (row_order.hpp) ─► slots
//
// kernels/cuda/README.md explains the terms.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cuda/layout/arrangement/outline.hpp"
#include "cuda/layout/arrangement/row_order.hpp"
#include "cuda/layout/arrangement/shape.hpp"

namespace evodevo::cuda {

/// The device index of each mass: masses are sorted by descending degree (number of springs), first that of cut
/// springs, so that masses in neighbouring lanes have similar numbers of springs.
std::vector<std::uint32_t> indices_by_degree(const Outline& outline);

/// The masses and springs of a body, or of a part of one, in the order of a thread block.
///
/// Masses are in groups of 32: each mass of a group has its own lane of a warp and its own bank of shared memory. A
/// spring is in a row of the group of the mass that owns it, in the lane of that mass; the lanes of a row add forces to
/// different banks as far as possible. The rows of all groups, one group after the other, are divided evenly among the
/// warps. Cut springs have rows and warps of their own, after all others; their owner is their mass in this part. The
/// arrangement influences the order in which energies and work are summed, and nothing else before a force has left its
/// range.
struct Arrangement {
  static constexpr std::uint32_t none = 0xffffffff;

  /// One lane of one row: a spring, or empty.
  struct Slot {
    std::uint32_t spring = none;  ///< index of the spring, or none; cut springs come after those inside
    std::uint32_t other = 0;      ///< index of the mass at the other end; in an empty slot, an index beyond all groups
  };

  /// Arranges a body, or a part of one.
  Arrangement(const Outline& outline, const Target& target);

  /// Arranges a body that has developed from one with the outline `before` and the arrangement `earlier`; both are in
  /// one part. If the remaining masses and springs are in the same order as before, most keep their indices, owners and
  /// rows, which saves most of the work. Any other body is arranged correctly as well.
  Arrangement(const Outline& outline, const Target& target, const Arrangement& earlier, const Outline& before);

  /// Arranges the parts of a body, for blocks of equal shape.
  static std::vector<Arrangement> of_parts(std::span<const Outline* const> parts, const Target& target);

  /// Index 32 * groups is that of the first mass that no spring joins, to which empty slots refer. The indices of the
  /// halo begin 32 later.
  std::uint32_t first_of_halo() const { return 32 * (groups + 1); }

  Shape shape;
  std::uint32_t groups = 0, halo_groups = 0, halo_masses = 0;
  std::vector<std::uint32_t> index_of;   ///< [masses, halo] the device index of each mass
  std::vector<Slot> slots;               ///< [warps][chunks][rows][32], then [cut_warps][chunks][cut_rows][32]
  std::vector<std::uint32_t> slot_of;    ///< [springs inside, cut springs] index into `slots`
  std::vector<std::uint32_t> first_row;  ///< [groups + 1] the rows of group g are first_row[g] .. first_row[g + 1] - 1
  std::vector<std::uint32_t> first_group;  ///< [block] the group that each warp begins with
  std::vector<std::uint32_t> group_ends;   ///< [block][chunks] bit r: a group or the warp's work ends with row r
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
  /// Springs of one kind (inside or cut), sorted by the group whose masses own them.
  struct Members {
    std::vector<std::size_t> rows;   ///< [groups] number of rows that the group needs
    std::vector<std::size_t> first;  ///< [groups + 1] index of the group's first spring
    std::vector<Link> links;         ///< [springs]
    std::vector<Slot> slots;         ///< [springs] the content of each spring's slot

    std::size_t all_rows() const;
    /// Adds rows, which stay empty, to the last group that has any.
    void fill_up(std::size_t to);
  };

  /// All springs, before the shape is known.
  struct Draft {
    Members inside, cut;
    Needs needs;
  };

  explicit Arrangement(const Outline& outline);
  /// The group of each row.
  std::vector<std::uint32_t> groups_of_rows() const;
  Draft draft(const Outline& outline, const Settled& settled);
  void fit(Draft draft, const Shape& into);
  void number_halo(const Outline& outline);
  Members members_inside(const Outline& outline, const Settled& settled);
  Members members_cut(const Outline& outline) const;
  Members members_of_groups(std::span<const std::uint32_t> owner) const;
  std::vector<std::uint32_t> assign_slots(Members& members, std::size_t first_row_of_all, unsigned first_warp,
                                          unsigned rows);
  void fill_empty_slots();
};

}  // namespace evodevo::cuda
