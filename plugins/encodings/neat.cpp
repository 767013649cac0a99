// A compositional pattern-producing network whose topology evolves (CPPN-NEAT: Stanley 2007; NEAT: Stanley and
// Miikkulainen 2002).
#include "evodevo/neat.hpp"

#include <stdexcept>
#include <string>

#include "evodevo/helpers/activations.hpp"
#include "evodevo/helpers/network_encoding.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Block;
using evodevo::Genome;
namespace neat = evodevo::neat;

/// First networks have 4 inputs (the coordinates of a point and its distance from the centre), outputs_in(context)
/// outputs, and a link from each input to each output. Mutations such as add-node and add-link let nodes and links come
/// and go. Inputs and outputs are known by the ids of their blocks; an output that is gone is 0. Outputs are linear. If
/// links form a cycle, the link that closes it has no effect.
class Neat final : public evodevo::NetworkEncoding {
 public:
  void parameters(evodevo::Parameters& p) override {
    NetworkEncoding::parameters(p);
    p.integer(nodes_, "nodes", {16, 1000, "1"}, "Largest number of nodes, with inputs and outputs.");
    p.integer(links_, "links", {64, 10'000, "1"}, "Largest number of links.");
  }

  evodevo::Layout layout(const evodevo::EncodingContext& context) const override {
    evodevo::Layout layout;
    const auto outputs = static_cast<std::uint32_t>(outputs_in(context));
    require_at_least("nodes", nodes_, inputs + outputs, outputs);
    require_at_least("links", links_, inputs * outputs, outputs);
    const neat::Types types = neat::add_types(layout, 3, evodevo::activation_names(),
                                              static_cast<std::uint32_t>(nodes_), static_cast<std::uint32_t>(links_));
    for (std::uint32_t i = 0; i < inputs + outputs; ++i) layout.add_block_of(types.node);
    for (std::uint32_t i = 0; i < inputs * outputs; ++i) layout.add_block_of(types.link);
    return layout;
  }

  Genome random(const evodevo::Layout& layout, evodevo::Rng& rng) const override {
    Genome genome = random_genome(layout, rng);
    std::uint32_t index = 0;
    for (const Block& block : genome.blocks) {
      if (block.count != link_genes) continue;
      genome[block.first + neat::on] = 1;
      genome[block.first + neat::from] = static_cast<float>(index % inputs);
      genome[block.first + neat::to] = static_cast<float>(inputs + index++ / inputs);
    }
    return genome;
  }

 private:
  static constexpr std::uint32_t inputs = 4;
  static constexpr std::uint32_t link_genes = 4;  ///< genes of a link; a node has two

  /// Throws std::invalid_argument if a first network needs more nodes or links than a genome may have.
  static void require_at_least(const std::string& name, std::int64_t value, std::uint32_t least,
                               std::uint32_t outputs) {
    if (value >= least) return;
    throw std::invalid_argument("`" + name + "` = " + std::to_string(value) + "; expected at least " +
                                std::to_string(least) + ", for a first network with " + std::to_string(inputs) +
                                " inputs and " + std::to_string(outputs) + " outputs");
  }

  /// One node of a network.
  struct Node {
    const float* genes;
    std::vector<const float*> links = {};     ///< that lead to it and are on
    Eigen::RowVectorXd values = {};           ///< one for each point; empty until they are computed
    bool is_linear = false, visited = false;  ///< `visited`: it is computed, or is being computed
  };

  /// Returns one item for each block, since references count all blocks; those of links remain unused.
  static std::vector<Node> nodes_of(const Genome& genome) {
    std::vector<Node> nodes;
    for (const Block& block : genome.blocks) nodes.push_back({&genome[block.first]});
    for (const Block& block : genome.blocks)
      if (const float* link = &genome[block.first]; block.count == link_genes && link[neat::on] != 0)
        nodes[static_cast<std::size_t>(link[neat::to])].links.push_back(link);
    return nodes;
  }

  /// Computes a node and, before it, the nodes from which links lead to it.
  static void compute(std::vector<Node>& nodes, Node& node, Eigen::Index points) {
    if (node.visited) return;
    node.visited = true;
    Eigen::RowVectorXd sum = Eigen::RowVectorXd::Constant(points, node.genes[neat::bias]);
    for (const float* link : node.links) {
      Node& source = nodes[static_cast<std::size_t>(link[neat::from])];
      compute(nodes, source, points);
      if (source.values.size() > 0) sum += link[neat::weight] * source.values;
    }
    const auto activation = evodevo::activations.at(static_cast<std::size_t>(node.genes[neat::function])).value;
    if (!node.is_linear) sum = sum.unaryExpr(activation).eval();
    node.values = std::move(sum);
  }

  Matrix map(const Genome& genome, const evodevo::Layout& layout, const Matrix& points,
             const evodevo::EncodingContext& context) const override {
    std::vector<Node> nodes = nodes_of(genome);
    const auto first_node = [&](Eigen::Index index) -> Node* {
      const auto block = find_block(genome, layout, layout.first_blocks[static_cast<std::size_t>(index)].id);
      return block ? &nodes[*block] : nullptr;
    };
    Matrix values(inputs, points.cols()), outputs = Matrix::Zero(outputs_in(context), points.cols());
    values << points, points.colwise().norm();
    for (Eigen::Index i = 0; i < inputs; ++i)
      if (Node* input = first_node(i)) input->values = values.row(i), input->visited = true;
    for (Eigen::Index i = 0; i < outputs.rows(); ++i)
      if (Node* output = first_node(inputs + i)) output->is_linear = true;
    for (Eigen::Index i = 0; i < outputs.rows(); ++i) {
      Node* output = first_node(inputs + i);
      if (output == nullptr) continue;
      compute(nodes, *output, points.cols());
      outputs.row(i) = output->values;
    }
    return outputs;
  }

  std::int64_t nodes_ = 64;
  std::int64_t links_ = 256;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Neat>("neat",
                                             "A network whose nodes and links evolve gives every point of a ball a "
                                             "position and a material (Stanley 2007)."))
