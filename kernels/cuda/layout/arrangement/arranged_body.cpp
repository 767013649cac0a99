#include "cuda/layout/arrangement/arranged_body.hpp"

#include <algorithm>
#include <utility>

#include "cuda/layout/arrangement/partition.hpp"

namespace evodevo::cuda {

std::shared_ptr<const ArrangedBody> ArrangedBody::of(const Body& body, unsigned blocks, const Target& target,
                                                     const std::shared_ptr<const Preparation>& earlier, Keep keep,
                                                     std::size_t needs) {
  const auto before = std::dynamic_pointer_cast<const ArrangedBody>(earlier);
  const bool similar = before && before->target_.largest_block == target.largest_block &&
                       before->blocks_.size() == blocks &&
                       (keep == Keep::all || (before->target_ == target && !before->patched_));
  if (similar && before->is_of(body)) return before;
  std::shared_ptr<ArrangedBody> arranged(new ArrangedBody(Outline(body), target));
  arranged->needs_ = needs;
  arranged->patched_ = similar && keep == Keep::all && blocks == 1;
  if (arranged->patched_)
    arranged->add(Arrangement(arranged->outline_, target, before->blocks_.front().arrangement, before->outline_), {});
  else
    arranged->arrange(blocks);
  return arranged;
}

bool ArrangedBody::is_of(const Body& body) const {
  // the parts of a body depend on where its masses are
  const auto is_there = [](const Vec3& rest, const Mass& mass) { return rest == mass.rest; };
  return outline_.fits(body) && (blocks_.size() == 1 || std::ranges::equal(outline_.rest, body.masses, is_there));
}

void ArrangedBody::arrange(unsigned blocks) {
  if (blocks == 1) return add(Arrangement(outline_, target_), {});
  std::vector<Part> parts = partition(outline_, blocks);
  std::vector<const Outline*> outlines;
  for (const Part& part : parts) outlines.push_back(&part.outline);
  std::vector<Arrangement> arrangements = Arrangement::of_parts(outlines, target_);
  for (std::size_t p = 0; p < parts.size(); ++p) add(std::move(arrangements[p]), std::move(parts[p].springs));
  index_of_.resize(outline_.rest.size());
  slot_of_.assign(outline_.ends.size(), Arrangement::none);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const auto& [arrangement, springs, copies, first_mass, first_slot] = blocks_[p];
    for (std::size_t i = 0; i < parts[p].outline.rest.size(); ++i)
      index_of_[parts[p].masses[i]] = first_mass + arrangement.index_of[i];
    for (std::size_t i = 0; i < springs.size(); ++i)
      if (std::uint32_t& slot = slot_of_[springs[i]]; slot == Arrangement::none)
        slot = first_slot + arrangement.slot_of[i];
  }
  find_copies(parts);
}

void ArrangedBody::add(Arrangement arrangement, std::vector<std::uint32_t> springs) {
  const std::size_t masses = 32 * arrangement.groups, slots = arrangement.slots.size();
  blocks_.push_back({.arrangement = std::move(arrangement),
                     .springs = std::move(springs),
                     .copies = {},
                     .first_mass = static_cast<std::uint32_t>(padded_masses_),
                     .first_slot = static_cast<std::uint32_t>(slots_)});
  padded_masses_ += masses;
  slots_ += slots;
}

/// Finds the block and the index there of each mass in each halo.
void ArrangedBody::find_copies(std::span<const Part> parts) {
  std::vector<std::uint32_t> block_of(index_of_.size());
  for (std::uint32_t p = 0; p < parts.size(); ++p)
    for (std::size_t i = 0; i < parts[p].outline.rest.size(); ++i) block_of[parts[p].masses[i]] = p;
  for (std::uint32_t p = 0; p < parts.size(); ++p) {
    const std::size_t own = parts[p].outline.rest.size();
    for (std::size_t i = own; i < parts[p].masses.size(); ++i) {
      const std::uint32_t mass = parts[p].masses[i];
      Block& home = blocks_[block_of[mass]];
      home.copies.push_back({index_of_[mass] - home.first_mass, p, blocks_[p].arrangement.index_of[i]});
    }
  }
  // successive threads write to successive places
  for (Block& block : blocks_)
    std::ranges::sort(block.copies, {}, [](const Copy& copy) { return std::pair(copy.block, copy.to); });
}

std::span<const std::uint32_t> ArrangedBody::index_of() const {
  return blocks_.size() == 1 ? blocks_.front().arrangement.index_of : index_of_;
}

std::span<const std::uint32_t> ArrangedBody::slot_of() const {
  return blocks_.size() == 1 ? blocks_.front().arrangement.slot_of : slot_of_;
}

}  // namespace evodevo::cuda
