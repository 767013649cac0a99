// The arrangement of a whole body in a block, or in the blocks of a cluster.
//
//   body ─► partition (partition.hpp) ─► Arrangement of each part ─► indices and slots of the body, copies between
//   blocks
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/simulator.hpp"
#include "cuda/layout/arrangement/arrangement.hpp"

namespace evodevo::cuda {

/// A body's arrangement, kept from one run to the next.
///
/// Masses and slots of all blocks are numbered one block after the other.
class ArrangedBody final : public Preparation {
 public:
  /// A mass of a block that is in the halo of another one.
  struct Copy {
    std::uint32_t from;   ///< its index in its own block
    std::uint32_t block;  ///< whose halo it is in
    std::uint32_t to;     ///< its index there
  };
  struct Block {
    Arrangement arrangement;
    std::vector<std::uint32_t> springs;  ///< the index in Body::springs of each spring; empty if it is the same
    std::vector<Copy> copies;            ///< in the order in which they are written
    std::uint32_t first_mass, first_slot;
  };

  /// How much of an earlier arrangement may be kept.
  enum class Keep {
    all,     ///< as much as possible; then the arrangement depends on the body's earlier life
    nothing  ///< the arrangement depends only on the body's outline and the target
  };

  /// The arrangement of `body` for `blocks` blocks: `earlier` if it fits, even if it was for other numbers of bodies,
  /// otherwise a new one. Several blocks are always arranged anew. A new arrangement gets `needs`.
  static std::shared_ptr<const ArrangedBody> of(const Body& body, unsigned blocks, const Target& target,
                                                const std::shared_ptr<const Preparation>& earlier, Keep keep,
                                                std::size_t needs = 0);

  /// Whether this is an arrangement of `body`.
  bool is_of(const Body& body) const;
  /// A number that the caller has given to remember why the body has so many blocks.
  std::size_t needs() const { return needs_; }

  const std::vector<Block>& blocks() const { return blocks_; }
  std::span<const std::uint32_t> index_of() const;  ///< [masses]
  std::span<const std::uint32_t> slot_of() const;   ///< [springs] the slot that sums over springs count
  std::size_t padded_masses() const { return padded_masses_; }
  std::size_t slots() const { return slots_; }

 private:
  ArrangedBody(Outline outline, const Target& target) : outline_(std::move(outline)), target_(target) {}

  void arrange(unsigned blocks);
  void add(Arrangement arrangement, std::vector<std::uint32_t> springs);
  void find_copies(std::span<const struct Part> parts);

  Outline outline_;
  Target target_;
  bool patched_ = false;  ///< whether it keeps anything of an earlier one
  std::size_t needs_ = 0;
  std::vector<Block> blocks_;
  std::vector<std::uint32_t> index_of_, slot_of_;  ///< of several blocks
  std::size_t padded_masses_ = 0, slots_ = 0;
};

}  // namespace evodevo::cuda
