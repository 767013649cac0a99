// An encoding whose genomes differ in length and whose blocks refer to each other.
#include <cmath>

#include "evodevo/blocks.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Vec3;

/// A tree of branches. Each branch leads from the end of its parent to a new mass. The first branch of the genome grows
/// from the base, whatever its parent is. Branches that do not descend from it do not grow.
class Limbs final : public evodevo::Encoding {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.integer(branches_, "branches", {4, 200, "1"}, "Number of branches of a random individual.");
    p.integer(most_, "most", {4, 200, "1"}, "Largest number of branches of a body.");
    p.real(length_, "length", {0.01, 10, "m"}, "Largest length of a branch.");
    p.require(branches_ <= most_, "branches", "expected at most `most`");
  }

  evodevo::Layout layout(const evodevo::EncodingContext& context) const override {
    const evodevo::GeneSpec length{0.25F, 1}, turn{-pi, pi}, tilt{-pi / 2, pi / 2};
    const evodevo::GeneSpec any_material{.choices = static_cast<std::uint32_t>(context.materials.size())};
    evodevo::Layout layout;
    layout.add_type({.name = "branch",
                     .genes = {length, turn, tilt, any_material, {.refers_to = 0}},
                     .least = 4,
                     .most = static_cast<std::uint32_t>(most_),
                     .gene_names = {"length", "turn", "tilt", "material", "parent"}});
    layout.types[0].name_options(material, context.material_names);
    for (std::int64_t i = 0; i < branches_; ++i) layout.add_block_of(0);
    return layout;
  }

  /// All branches of a first genome descend from the first branch.
  evodevo::Genome random(const evodevo::Layout& layout, evodevo::Rng& rng) const override {
    evodevo::Genome genome = random_genome(layout, rng);
    const std::vector<evodevo::Block>& branches = layout.blocks(genome);
    for (std::uint32_t i = 0; i < branches.size(); ++i)
      genome[branches[i].first + parent] = static_cast<float>(i == 0 ? 0 : rng.below(i));
    return genome;
  }

  evodevo::Blueprint decode(const evodevo::Genome& genome, const evodevo::Layout& layout,
                            const evodevo::EncodingContext& context) const override {
    evodevo::Blueprint blueprint;
    blueprint.body.materials = context.materials;
    const std::vector<Node> nodes = tree(genome, layout);
    for (const Node& node : nodes) blueprint.body.masses.push_back({node.position, context.mass, node.material});
    for (std::uint32_t i = 1; i < nodes.size(); ++i) {
      join(blueprint.body, i, nodes[i].parent, nodes[i].material);
      brace(blueprint.body, nodes, i);
    }
    if (blueprint.body.springs.empty()) blueprint.failure = "no branch grows";
    return blueprint;
  }

 private:
  enum Gene : std::uint32_t { length, turn, tilt, material, parent };
  static constexpr float pi = 3.14159265F;

  /// A mass of the body: the base, or the end of a branch.
  struct Node {
    Vec3 position;
    std::int32_t material;
    std::uint32_t parent, branch;
  };

  /// Returns the nodes that descend from the base, parents before children. The base is its own parent.
  std::vector<Node> tree(const evodevo::Genome& genome, const evodevo::Layout& layout) const {
    const std::vector<evodevo::Block>& branches = layout.blocks(genome);
    std::vector<Node> nodes = {{{}, material_of(genome, branches[0]), 0, 0}};
    const auto grow = [&](std::uint32_t branch, std::uint32_t from) {
      const Vec3 place = nodes[from].position + way_of(genome, branches[branch]);
      nodes.push_back({place, material_of(genome, branches[branch]), from, branch});
    };
    grow(0, 0);
    for (std::uint32_t node = 1; node < nodes.size(); ++node)
      for (std::uint32_t branch = 1; branch < branches.size(); ++branch)
        if (target_of(genome, layout, branches[branch], parent) == nodes[node].branch) grow(branch, node);
    return nodes;
  }

  static std::int32_t material_of(const evodevo::Genome& genome, const evodevo::Block& branch) {
    return static_cast<std::int32_t>(genome[branch.first + material]);
  }

  /// Returns the way from the beginning to the end of a branch, m.
  Vec3 way_of(const evodevo::Genome& genome, const evodevo::Block& branch) const {
    const double around = genome[branch.first + turn], up = genome[branch.first + tilt];
    const Vec3 direction{std::cos(up) * std::cos(around), std::cos(up) * std::sin(around), std::sin(up)};
    return (length_ * genome[branch.first + length]) * direction;
  }

  /// Joins a node to its grandparent and to the other children of its parent, so that the angle of its branch is kept.
  static void brace(evodevo::Body& body, const std::vector<Node>& nodes, std::uint32_t node) {
    const std::uint32_t above = nodes[node].parent;
    if (nodes[above].parent != above) join(body, node, nodes[above].parent, nodes[node].material);
    for (std::uint32_t sibling = 1; sibling < node; ++sibling)
      if (nodes[sibling].parent == above) join(body, node, sibling, nodes[node].material);
  }

  static void join(evodevo::Body& body, std::uint32_t a, std::uint32_t b, std::int32_t of) {
    const double distance = norm(body.masses[a].rest - body.masses[b].rest);
    if (distance < 1e-3) return;  // two ends at one place, such as those of a branch and its copy
    body.springs.push_back({a, b, distance, static_cast<std::uint32_t>(of)});
  }

  std::int64_t branches_ = 12;
  std::int64_t most_ = 40;
  double length_ = 0.5;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Limbs>("outside.limbs", "A tree of branches that come and go."))
