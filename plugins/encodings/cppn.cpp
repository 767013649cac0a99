// A compositional pattern-producing network: neurons whose functions, and so the patterns' symmetries and repetitions,
// evolve with the weights (Stanley 2007). Here its topology is fixed.
#include <array>
#include <cmath>

#include "evodevo/plugin.hpp"
#include "network_encoding.hpp"

namespace {

/// The functions that a neuron may have: Stanley's, each about as large as its argument is around 1.
constexpr std::array<double (*)(double), 5> functions = {
    [](double x) { return x; },           [](double x) { return std::tanh(x); },
    [](double x) { return std::sin(x); }, [](double x) { return std::exp(-x * x); },
    [](double x) { return std::abs(x); },
};

/// A network 4 - hidden - hidden - outputs_in(context); its inputs are a point's coordinates and its distance from the
/// centre. One gene group for each neuron: its function (that of an output neuron is the identity and no gene), its
/// bias, then the weights that come in, up to 3 as usual with such networks, so that a sine repeats itself.
class Cppn final : public NetworkEncoding {
 public:
  evodevo::Layout layout(const evodevo::EncodingContext& context) const override {
    evodevo::Layout layout;
    add_hidden_layer(layout, 4);
    add_hidden_layer(layout, hidden());
    for (std::int64_t n = 0; n < outputs_in(context); ++n)
      layout.add_group(static_cast<std::uint32_t>(1 + hidden()), weight);
    return layout;
  }

 private:
  static constexpr evodevo::GeneSpec weight = {-3, 3};

  void add_hidden_layer(evodevo::Layout& layout, std::int64_t inputs) const {
    std::vector<evodevo::GeneSpec> neuron(static_cast<std::size_t>(2 + inputs), weight);
    neuron.front() = {0, 0, static_cast<std::uint32_t>(functions.size())};
    for (std::int64_t n = 0; n < hidden(); ++n) layout.add_group(neuron);
  }

  Matrix hidden_layer(const float*& genes, const Matrix& input) const {
    const Matrix rows = next_rows(genes, hidden(), 2 + input.rows());
    Matrix values = sums(rows.rightCols(1 + input.rows()), input);
    for (Eigen::Index n = 0; n < values.rows(); ++n)
      values.row(n) = values.row(n).unaryExpr(functions.at(static_cast<std::size_t>(rows(n, 0))));
    return values;
  }

  Matrix map(const float* genes, const Matrix& points, Eigen::Index outputs) const override {
    Matrix inputs(4, points.cols());
    inputs << points, points.colwise().norm();
    const Matrix first = hidden_layer(genes, inputs);
    const Matrix second = hidden_layer(genes, first);
    return sums(next_rows(genes, outputs, 1 + hidden()), second);
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Cppn>("cppn",
                                             "A network whose neurons' functions evolve gives every point of a ball "
                                             "a place and a material (Stanley 2007)."))
