// The paper's encoding (section IV-A1, Fig. 1): a small neural network maps the points of a ball to places in a cube
// and gives each a material; every place becomes a mass that is joined to its nearest neighbours.
#include <Eigen/Core>
#include <cmath>

#include "chosen.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Genome;
using evodevo::Layout;
using evodevo::World;
using Matrix = Eigen::MatrixXd;

/// A network 3 - hidden - hidden - (3 + materials), ReLU within, one gene group for each neuron: its bias, then the
/// weights that come in. Where the paper is silent: the points are uniform in the ball, biases are genes like the
/// weights, and places lie in [-side/2, side/2]^3.
class Neural final : public evodevo::Encoding {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.integer(points_, "points", {2, 100'000, "1"}, "Points in the ball, each of which becomes a mass.");
    p.integer(points_seed_, "points_seed", {0, 4294967295.0, "1"}, "Seed from which the points are drawn.");
    p.integer(neighbours_, "neighbours", {1, 1000, "1"}, "Nearest neighbours that every mass is joined to.");
    p.integer(hidden_, "hidden", {1, 1000, "1"}, "Neurons in each of the two hidden layers.");
    p.real(side_, "side", {0.001, 1000, "m"}, "Side of the cube in which the masses lie.");
    p.materials(materials_, "materials", "Materials that a mass may have; an empty list stands for all.");
  }

  Layout layout(const World& world) const override {
    const auto outputs = 3 + static_cast<std::int64_t>(world.material_indices(materials_).size());
    Layout layout;
    add_layer(layout, hidden_, 3);
    add_layer(layout, hidden_, hidden_);
    add_layer(layout, outputs, hidden_);
    return layout;
  }

  evodevo::Blueprint decode(const Genome& genome, const World& world) const override {
    const auto chosen = world.material_indices(materials_);
    if (auto reason = why_no_body(world, chosen); !reason.empty()) return {{}, 0, reason};
    if (!std::all_of(genome.begin(), genome.end(), [](float gene) { return std::isfinite(gene); }))
      return {{}, 0, "a gene is not finite"};

    const auto materials = static_cast<Eigen::Index>(chosen.size());
    const float* genes = genome.data();
    const Matrix points = ball(world);
    const Matrix first = layer(genes, hidden_, points).cwiseMax(0);
    const Matrix second = layer(genes, hidden_, first).cwiseMax(0);
    const Matrix outputs = layer(genes, 3 + materials, second);

    evodevo::Blueprint blueprint;
    blueprint.body.materials = world.materials;
    blueprint.neighbours = static_cast<std::uint32_t>(neighbours_);
    for (const auto& output : outputs.colwise()) {
      // softmax, which the paper puts before the maximum, does not change where the maximum is
      Eigen::Index material = 0;
      output.tail(materials).maxCoeff(&material);
      blueprint.body.masses.push_back(
          {{place(output[0]), place(output[1]), place(output[2])}, world.mass, chosen[static_cast<size_t>(material)]});
    }
    for (const auto& point : points.colwise()) blueprint.origins.push_back({point[0], point[1], point[2]});
    return blueprint;
  }

 private:
  static void add_layer(Layout& layout, std::int64_t neurons, std::int64_t inputs) {
    for (std::int64_t n = 0; n < neurons; ++n) layout.add_group(static_cast<std::uint32_t>(1 + inputs), {-1, 1});
  }

  /// What a layer of neurons sums up, one column for each point; `genes` moves on behind the layer's own.
  static Matrix layer(const float*& genes, Eigen::Index neurons, const Matrix& input) {
    using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Matrix rows = Eigen::Map<const Rows>(genes, neurons, 1 + input.rows()).cast<double>();
    genes += rows.size();
    // a lazy product sums in one order, the blocked one in an order that depends on the size of the caches
    return rows.rightCols(input.rows()).lazyProduct(input).colwise() + rows.col(0);
  }

  /// The run's points, uniform in the unit ball, as columns.
  Matrix ball(const World& world) const {
    evodevo::Rng rng = world.rng(static_cast<std::uint64_t>(points_seed_));
    Matrix points(3, points_);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      do {
        for (Eigen::Index axis = 0; axis < 3; ++axis) points(axis, i) = rng.uniform(-1, 1);
      } while (points.col(i).squaredNorm() > 1);
    }
    return points;
  }

  double place(double output) const { return side_ / 2 * std::tanh(output); }

  std::int64_t points_ = 1000;
  std::int64_t points_seed_ = 1;
  std::int64_t neighbours_ = 25;
  std::int64_t hidden_ = 25;
  double side_ = 2;
  std::vector<std::string> materials_;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Neural>(
                   "neural",
                   "A neural network gives every point of a ball a place and a material, and nearest neighbours are "
                   "joined (paper, section IV-A1)."))
