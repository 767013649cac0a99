// "Add node" of NEAT (Stanley and Miikkulainen 2002): a node splits a link.
#include "evodevo/neat.hpp"
#include "evodevo/plugin.hpp"

namespace {

/// Turns a link off and adds a node in its place. The link to the node has the weight 1 and the link from it the weight
/// of the old one, so that a linear node changes nothing at first. The ids derive from the id of the old link: the same
/// split in two genomes is the same innovation. A link that has been split is not split again while any of the blocks
/// that this gave is still there.
class AddNode final : public evodevo::Mutation {
 public:
  evodevo::Traits traits() const override { return {.block_types = {"node", "link"}}; }

  void mutate(evodevo::Genome& genome, const evodevo::VariationContext& context, evodevo::Rng& rng) const override {
    const evodevo::Layout& layout = context.layout;
    const auto types = evodevo::neat::types_in(layout);
    if (!types || !has_room(genome, layout, *types)) return;
    std::vector<std::uint32_t> whole;  // links that are on and have not been split
    for (std::uint32_t i = 0; i < genome.blocks.size(); ++i) {
      const evodevo::Block& block = genome.blocks[i];
      if (block.type == types->link && genome[block.first + evodevo::neat::on] != 0 &&
          !is_split(genome, layout, *types, block.id))
        whole.push_back(i);
    }
    if (!whole.empty()) split(genome, layout, *types, whole[rng.below(static_cast<std::uint32_t>(whole.size()))], rng);
  }

 private:
  enum Role : std::uint32_t { role_node, role_in, role_out };
  using Types = evodevo::neat::Types;

  static bool has_room(const evodevo::Genome& genome, const evodevo::Layout& layout, const Types& types) {
    return count_blocks(genome, layout, types.node) < layout.types[types.node].most &&
           count_blocks(genome, layout, types.link) + 2 <= layout.types[types.link].most;
  }

  /// Whether a block is there that a split of this link has given. Its links can outlive the node: other mutations may
  /// redirect them before it is removed.
  static bool is_split(const evodevo::Genome& genome, const evodevo::Layout& layout, const Types& types,
                       evodevo::BlockId link) {
    const auto is_there = [&](Role role, std::uint32_t type) {
      return find_block(genome, layout, evodevo::derived_id(link, role), layout.types[type].section).has_value();
    };
    return is_there(role_node, types.node) || is_there(role_in, types.link) || is_there(role_out, types.link);
  }

  static void split(evodevo::Genome& genome, const evodevo::Layout& layout, const Types& types, std::uint32_t link,
                    evodevo::Rng& rng) {
    const evodevo::Block old = genome.blocks[link];
    const evodevo::GeneSpec& function = layout.types[types.node].gene(evodevo::neat::function);
    const float weight = genome[old.first + evodevo::neat::weight], from = genome[old.first + evodevo::neat::from],
                to = genome[old.first + evodevo::neat::to];
    genome[old.first + evodevo::neat::on] = 0;
    const std::vector<float> node = {0, function.draw(rng)};
    const std::uint32_t added = add_block(genome, layout, types.node, node, evodevo::derived_id(old.id, role_node));
    const auto middle = static_cast<float>(added - layout.section_begin(genome, layout.types[types.node].section));
    const std::vector<float> in = {1, 1, from, middle}, out = {weight, 1, middle, to};
    add_block(genome, layout, types.link, in, evodevo::derived_id(old.id, role_in));
    add_block(genome, layout, types.link, out, evodevo::derived_id(old.id, role_out));
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<AddNode>("add-node",
                                                "Splits a link of a network by a new node (Stanley and Miikkulainen "
                                                "2002)."))
