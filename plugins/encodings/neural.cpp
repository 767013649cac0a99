// The paper's encoding (section IV-A1, Fig. 1): a small neural network maps each point of a ball to a position in a
// cube and to a material. At each position there is a mass, which is joined to its nearest neighbours.
#include "evodevo/helpers/network_encoding.hpp"
#include "evodevo/plugin.hpp"

namespace {

/// A fully connected network with 3 inputs, two layers of hidden() neurons with ReLU, and outputs_in(context) linear
/// outputs. Each neuron has one block of genes: its bias, then its input weights. The paper does not mention biases;
/// here they are genes like the weights.
class Neural final : public evodevo::LayeredNetworkEncoding {
 public:
  evodevo::Layout layout(const evodevo::EncodingContext& context) const override {
    evodevo::Layout layout;
    add_layer(layout, hidden(), 3);
    add_layer(layout, hidden(), hidden());
    add_layer(layout, outputs_in(context), hidden());
    layout.types.front().gene_names = {"bias", "weight"};
    return layout;
  }

 private:
  static void add_layer(evodevo::Layout& layout, std::int64_t neurons, std::int64_t inputs) {
    for (std::int64_t n = 0; n < neurons; ++n)
      layout.add_block(static_cast<std::uint32_t>(1 + inputs), {-1, 1}, "neuron");
  }

  static Matrix layer(const float*& genes, Eigen::Index neurons, const Matrix& input) {
    return sums(next_rows(genes, neurons, 1 + input.rows()), input);
  }

  Matrix map(const evodevo::Genome& genome, const evodevo::Layout&, const Matrix& points,
             const evodevo::EncodingContext& context) const override {
    const float* genes = genome.data();
    const Matrix first = layer(genes, hidden(), points).cwiseMax(0);
    const Matrix second = layer(genes, hidden(), first).cwiseMax(0);
    return layer(genes, outputs_in(context), second);
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Neural>(
                   "neural",
                   "A neural network maps every point of a ball to a place and a material, and nearest neighbours are "
                   "joined (paper, section IV-A1)."))
