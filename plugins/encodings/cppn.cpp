// A compositional pattern-producing network (Stanley 2007): the activation functions of the neurons evolve together
// with the weights. The functions determine the symmetries and repetitions of the pattern. Here the topology of the
// network is fixed.
#include "evodevo/helpers/activations.hpp"
#include "evodevo/helpers/network_encoding.hpp"
#include "evodevo/plugin.hpp"

namespace {

/// A fully connected network with 4 inputs, two layers of hidden() neurons, and outputs_in(context) outputs. The inputs
/// are the coordinates of a point and its distance from the centre. Each neuron has one block of genes: its activation
/// function, its bias, then its input weights. Output neurons have no gene for the function, which is the identity.
/// Biases and weights are in [-3, 3], as is usual for such networks, so that a sine can go through several periods.
class Cppn final : public evodevo::LayeredNetworkEncoding {
 public:
  evodevo::Layout layout(const evodevo::EncodingContext& context) const override {
    evodevo::Layout layout;
    add_hidden_layer(layout, 4);
    add_hidden_layer(layout, hidden());
    for (std::int64_t n = 0; n < outputs_in(context); ++n)
      layout.add_block(static_cast<std::uint32_t>(1 + hidden()), weight, "output");
    for (evodevo::BlockType& type : layout.types) {
      if (type.name != "neuron") continue;
      type.name_options(0, evodevo::activation_names());
    }
    layout.types.front().gene_names = {"function", "bias", "weight"};
    layout.types.back().gene_names = {"bias", "weight"};
    return layout;
  }

 private:
  static constexpr evodevo::GeneSpec weight = {-3, 3};

  void add_hidden_layer(evodevo::Layout& layout, std::int64_t inputs) const {
    std::vector<evodevo::GeneSpec> neuron(static_cast<std::size_t>(2 + inputs), weight);
    neuron.front() = {0, 0, static_cast<std::uint32_t>(evodevo::activations.size())};
    for (std::int64_t n = 0; n < hidden(); ++n) layout.add_block(neuron, "neuron");
  }

  Matrix hidden_layer(const float*& genes, const Matrix& input) const {
    const Matrix rows = next_rows(genes, hidden(), 2 + input.rows());
    Matrix values = sums(rows.rightCols(1 + input.rows()), input);
    for (Eigen::Index n = 0; n < values.rows(); ++n)
      values.row(n) = values.row(n).unaryExpr(evodevo::activations.at(static_cast<std::size_t>(rows(n, 0))).value);
    return values;
  }

  Matrix map(const evodevo::Genome& genome, const evodevo::Layout&, const Matrix& points,
             const evodevo::EncodingContext& context) const override {
    const float* genes = genome.data();
    Matrix inputs(4, points.cols());
    inputs << points, points.colwise().norm();
    const Matrix first = hidden_layer(genes, inputs);
    const Matrix second = hidden_layer(genes, first);
    return sums(next_rows(genes, outputs_in(context), 1 + hidden()), second);
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Cppn>("cppn",
                                             "A network whose neurons' functions evolve maps every point of a ball "
                                             "to a place and a material (Stanley 2007)."))
