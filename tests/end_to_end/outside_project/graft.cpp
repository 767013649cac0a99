// A crossover of genomes whose blocks come and go and refer to each other.
#include "evodevo/plugin.hpp"

namespace {

/// The child is the first parent with a part of its mate grafted on: a random block that it lacks, all blocks that
/// refer to this one, and all that these need. Of a tree, this is a branch with everything that grows from it. If the
/// child would have too many blocks, another block is tried.
class Graft final : public evodevo::Crossover {
 public:
  evodevo::Genome cross(const evodevo::Parents& parents, const evodevo::VariationContext& context,
                        evodevo::Rng& rng) const override {
    const evodevo::Layout& layout = context.layout;
    evodevo::Genome child = parents.first;
    const auto partners = homologous(parents.second, child, layout);
    std::vector<std::uint32_t> new_to_it;
    for (std::uint32_t block = 0; block < partners.size(); ++block)
      if (!partners[block]) new_to_it.push_back(block);
    rng.shuffle(new_to_it);
    for (const std::uint32_t block : new_to_it)
      if (graft_block(child, parents.second, block, layout)) break;
    return child;
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Graft>("outside.graft",
                                              "Grafts a part of the mate, such as a branch of a tree, on a copy of the "
                                              "parent."))
