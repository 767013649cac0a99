// "Add connection" of NEAT (Stanley and Miikkulainen 2002): a link joins two nodes.
#include "evodevo/neat.hpp"
#include "evodevo/plugin.hpp"

namespace {

/// Adds a link with a random weight between two nodes that no link joins yet in this direction. Its id derives from the
/// ids of the nodes: the same link in two genomes is the same innovation.
class AddLink final : public evodevo::Mutation {
 public:
  evodevo::Traits traits() const override { return {.block_types = {"node", "link"}}; }

  void parameters(evodevo::Parameters& p) override {
    p.integer(attempts_, "attempts", {1, 1000, "1"}, "Random pairs of nodes that are tried.");
  }

  void mutate(evodevo::Genome& genome, const evodevo::VariationContext& context, evodevo::Rng& rng) const override {
    const evodevo::Layout& layout = context.layout;
    const auto types = evodevo::neat::types_in(layout);
    if (!types || count_blocks(genome, layout, types->link) >= layout.types[types->link].most) return;
    const std::uint32_t section = layout.types[types->node].section, begin = layout.section_begin(genome, section);
    std::vector<std::uint32_t> nodes;
    for (std::uint32_t i = 0; i < genome.blocks.size(); ++i)
      if (genome.blocks[i].type == types->node) nodes.push_back(i);
    if (nodes.empty()) return;
    const auto any_node = [&] { return nodes[rng.below(static_cast<std::uint32_t>(nodes.size()))]; };
    for (std::int64_t attempt = 0; attempt < attempts_; ++attempt) {
      const std::uint32_t from = any_node(), to = any_node();
      const evodevo::BlockId id = evodevo::derived_id(genome.blocks[from].id, genome.blocks[to].id, 0);
      if (from == to || joins(genome, types->link, from - begin, to - begin) || find_block(genome, layout, id, section))
        continue;
      const std::vector<float> link = {layout.types[types->link].gene(evodevo::neat::weight).draw(rng), 1,
                                       static_cast<float>(from - begin), static_cast<float>(to - begin)};
      add_block(genome, layout, types->link, link, id);
      return;
    }
  }

 private:
  /// Whether there is a link between two nodes, which are counted within their section.
  static bool joins(const evodevo::Genome& genome, std::uint32_t link_type, std::uint32_t from, std::uint32_t to) {
    return std::any_of(genome.blocks.begin(), genome.blocks.end(), [&](const evodevo::Block& block) {
      return block.type == link_type && genome[block.first + evodevo::neat::from] == static_cast<float>(from) &&
             genome[block.first + evodevo::neat::to] == static_cast<float>(to);
    });
  }

  std::int64_t attempts_ = 20;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<AddLink>("add-link",
                                                "Joins two nodes of a network by a new link (Stanley and "
                                                "Miikkulainen 2002)."))
