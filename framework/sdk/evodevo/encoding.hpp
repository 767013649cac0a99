// Encodings: from genes to a body.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "evodevo/genome.hpp"
#include "evodevo/operator.hpp"

namespace evodevo {

/// What every body of an experiment is made from.
struct EncodingContext {
  std::vector<std::string> material_names;
  std::vector<Material> materials;  ///< in the order of their names
  double mass = 0.2;                ///< of one point mass, kg
  Rng::Philox philox = nullptr;

  /// A stream of random numbers that depends on `seed` alone.
  Rng rng(std::uint64_t seed) const { return Rng(philox, {seed, 0, 0, 0}); }

  /// The indices of the named materials; of all where `names` is empty.
  std::vector<std::int32_t> material_indices(const std::vector<std::string>& names) const {
    std::vector<std::int32_t> indices;
    for (std::size_t i = 0; i < material_names.size(); ++i)
      if (names.empty() || std::find(names.begin(), names.end(), material_names[i]) != names.end())
        indices.push_back(static_cast<std::int32_t>(i));
    return indices;
  }
};

/// What the distance of two rest positions is multiplied by for the rest length of a spring between them: the mean of
/// both masses' sizes.
struct Size {
  double start = 1;  ///< at birth
  double end = 1;    ///< at the end of a ballistic development
};

/// A body as an encoding leaves it. The host joins neighbours, drops springs of air and masses without springs, keeps
/// the largest piece, and puts it on the floor.
struct Blueprint {
  Body body;  ///< `materials` begins with those of the context, in their order
  std::uint32_t neighbours =
      0;                ///< > 0: every mass is joined to as many nearest ones; materials: mean of the two masses'
  std::string failure;  ///< why there is no body; empty where there is one
  std::vector<Vec3> paired_at = {};  ///< where neighbours are searched for, one place for each mass; empty: at the rest
                                     ///< positions
  std::vector<Size> sizes = {};      ///< for the springs to neighbours, one for each mass; empty: all are 1
  std::vector<Vec3> origins = {};  ///< of an encoding that maps points: the point of each mass, for pictures; or empty
};

class Encoding : public Operator {
 public:
  static constexpr std::string_view kind = "encoding";

  virtual Layout layout(const EncodingContext& context) const = 0;
  virtual Genome random(const Layout& layout, Rng& rng) const { return random_genome(layout, rng); }
  virtual Blueprint decode(const Genome& genome, const EncodingContext& context) const = 0;
  /// Whether springs may grow: whether it sets Blueprint::sizes or Spring::growth.
  virtual bool sets_growth() const { return false; }
};

}  // namespace evodevo
