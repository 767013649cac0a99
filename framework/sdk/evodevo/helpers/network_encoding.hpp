// For encodings that map points to masses with a network (paper, section IV-A1). Needs Eigen 3.4.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "evodevo/encoding.hpp"
#include "evodevo/helpers/materials.hpp"

namespace evodevo {

/// A network that maps each point of a ball to a mass, that is, to a position in a cube and a material. Nearest
/// neighbours are joined. The paper leaves two choices open: here, the points are uniformly distributed in the ball,
/// and the positions lie in [-side/2, side/2]^3. Neighbours are determined among the positions or, as the paper
/// proposes in section VII, among the points. If `size_range` is above 0, each mass has a size at birth and a size at
/// the end of development (Kriegman et al. 2017).
class NetworkEncoding : public Encoding {
 public:
  void parameters(Parameters& p) override {
    p.integer(points_, "points", {2, 100'000, "1"}, "Number of points in the ball, each of which becomes a mass.");
    p.integer(points_seed_, "points_seed", {0, 4294967295.0, "1"}, "Seed of the random points in the ball.");
    p.integer(neighbours_, "neighbours", {1, 1000, "1"}, "Number of nearest neighbours that every mass is joined to.");
    p.choice(pairing_, "pairing", {"after-mapping", "before-mapping"},
             "Which masses count as neighbours: those whose places in the body are near, or those whose points in the "
             "ball are.");
    p.real(side_, "side", {0.001, 1000, "m"}, "Side length of the cube in which the masses lie.");
    p.materials(materials_, "materials", "Materials that a mass may have; an empty list stands for all.");
    p.real(size_range_, "size_range", {0, 0.9, "1"},
           "Largest fraction by which a mass can make its springs longer or shorter, at birth and, with "
           "ballistic-growth, at the end of development; 0: no genes for this.");
  }

  /// Draws the points, which are the same for all bodies.
  void prepare(const EncodingContext& context) override { ball_ = ball(context); }

  Blueprint decode(const Genome& genome, const Layout& layout, const EncodingContext& context) const final {
    const auto chosen = context.material_indices(materials_);
    if (auto reason = why_no_body(context, chosen); !reason.empty()) return {{}, 0, reason};
    if (!std::all_of(genome.begin(), genome.end(), [](float gene) { return std::isfinite(gene); }))
      return {{}, 0, "a gene is not finite"};

    const Matrix outputs = map(genome, layout, ball_, context);
    const auto materials = static_cast<Eigen::Index>(chosen.size());
    Blueprint blueprint;
    blueprint.body.materials = context.materials;
    blueprint.neighbours = static_cast<std::uint32_t>(neighbours_);
    for (const auto& output : outputs.colwise()) {
      // the paper applies a softmax before it takes the maximum; that does not change where the maximum is
      Eigen::Index material = 0;
      output.segment(3, materials).maxCoeff(&material);
      blueprint.body.masses.push_back({{position(output[0]), position(output[1]), position(output[2])},
                                       context.mass,
                                       chosen[static_cast<size_t>(material)]});
      if (size_range_ == 0) continue;
      const double birth = size(output[3 + materials]), end = size(output[4 + materials]);
      if (!std::isfinite(birth) || !std::isfinite(end)) return {{}, 0, "the size of a mass is not finite"};
      blueprint.mass_memory[size_at_birth].push_back(birth);
      blueprint.mass_memory[size_at_end].push_back(end);
    }
    for (const auto& point : ball_.colwise()) blueprint.origins.push_back({point[0], point[1], point[2]});
    if (pairing_ == "before-mapping") blueprint.paired_at = blueprint.origins;
    return blueprint;
  }

  std::vector<std::string> spring_memory() const final {
    return size_range_ > 0 ? std::vector<std::string>{"growth"} : std::vector<std::string>();
  }

  /// The rest length of a spring is the distance of its masses times the mean of their sizes.
  void joined(Blueprint& blueprint) const final {
    if (size_range_ == 0) return;
    const std::vector<double>&births = blueprint.mass_memory[size_at_birth], &ends = blueprint.mass_memory[size_at_end];
    std::vector<double>& growth = blueprint.spring_memory["growth"];
    for (Spring& spring : blueprint.body.springs) {
      const double birth = (births[spring.a] + births[spring.b]) / 2, end = (ends[spring.a] + ends[spring.b]) / 2;
      spring.rest_length *= birth;
      growth.push_back(double{static_cast<float>(end / birth)} - 1);
    }
  }

 protected:
  using Matrix = Eigen::MatrixXd;

  /// Returns the number of outputs of the network: x, y and z; one value for each material to choose from, the greatest
  /// of which selects the material; and, if `size_range` is above 0, the size at birth and the size at the end.
  std::int64_t outputs_in(const EncodingContext& context) const {
    return 3 + static_cast<std::int64_t>(context.material_indices(materials_).size()) + (size_range_ > 0 ? 2 : 0);
  }

 private:
  /// What masses remember at birth: their sizes.
  static constexpr const char *size_at_birth = "size at birth", *size_at_end = "size at the end";

  /// Returns the network's outputs, one column for each point.
  virtual Matrix map(const Genome& genome, const Layout& layout, const Matrix& points,
                     const EncodingContext& context) const = 0;

  /// Returns the points as columns, uniformly distributed in the unit ball.
  Matrix ball(const EncodingContext& context) const {
    Rng rng = context.rng(static_cast<std::uint64_t>(points_seed_));
    Matrix points(3, points_);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      do {
        for (Eigen::Index axis = 0; axis < 3; ++axis) points(axis, i) = rng.uniform(-1, 1);
      } while (points.col(i).squaredNorm() > 1);
    }
    return points;
  }

  double position(double output) const { return side_ / 2 * std::tanh(output); }
  double size(double output) const { return 1 + size_range_ * std::tanh(output); }

  std::int64_t points_ = 1000;
  std::int64_t points_seed_ = 1;
  std::int64_t neighbours_ = 25;
  std::string pairing_ = "after-mapping";
  double side_ = 2;
  std::vector<std::string> materials_;
  double size_range_ = 0;
  Matrix ball_;  ///< one column for each point
};

/// A network with two layers of hidden neurons, whose topology is fixed.
class LayeredNetworkEncoding : public NetworkEncoding {
 public:
  void parameters(Parameters& p) override {
    NetworkEncoding::parameters(p);
    p.integer(hidden_, "hidden", {1, 1000, "1"}, "Number of neurons in each of the two hidden layers.");
  }

 protected:
  /// Returns the number of neurons in each of the two hidden layers.
  std::int64_t hidden() const { return hidden_; }

  /// Returns the weighted sums of a layer of neurons plus their biases: one row for each neuron, one column for each
  /// point. `rows` has one row for each neuron, with its bias and then its weights.
  static Matrix sums(const Matrix& rows, const Matrix& input) {
    // A lazy product always sums in the same order. Eigen's default product sums in an order that depends on the sizes
    // of the caches, and would thus give different bits on different machines.
    return rows.rightCols(input.rows()).lazyProduct(input).colwise() + rows.col(0);
  }

  /// Returns the next `neurons` blocks of `count` genes as the rows of a matrix, and moves `genes` past them.
  static Matrix next_rows(const float*& genes, Eigen::Index neurons, Eigen::Index count) {
    using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Matrix rows = Eigen::Map<const Rows>(genes, neurons, count).cast<double>();
    genes += rows.size();
    return rows;
  }

 private:
  std::int64_t hidden_ = 25;
};

}  // namespace evodevo
