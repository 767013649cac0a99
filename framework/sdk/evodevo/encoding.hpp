// Encodings: they turn a genome into a body.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "evodevo/genome.hpp"
#include "evodevo/operator.hpp"

namespace evodevo {

/// The context of an encoding: the materials and the mass from which all bodies of an experiment are made.
struct EncodingContext {
  std::vector<std::string> material_names;
  std::vector<Material> materials;  ///< the materials, in the order of `material_names`
  double mass = 0.2;                ///< mass that one point mass should have, kg
  Rng::Philox philox = nullptr;     ///< the generator behind rng()

  /// Returns a stream of random numbers that depends on `seed` alone.
  Rng rng(std::uint64_t seed) const { return Rng(philox, {seed, 0, 0, 0}); }

  /// Returns the indices of the named materials in ascending order, or of all materials if `names` is empty.
  std::vector<std::int32_t> material_indices(const std::vector<std::string>& names) const {
    std::vector<std::int32_t> indices;
    for (std::size_t i = 0; i < material_names.size(); ++i)
      if (names.empty() || std::find(names.begin(), names.end(), material_names[i]) != names.end())
        indices.push_back(static_cast<std::int32_t>(i));
    return indices;
  }
};

/// The result of an encoding. To make a body from it, the host joins neighbours, drops springs of air and masses
/// without springs, keeps the largest connected piece, and puts that piece on the floor.
struct Blueprint {
  Body body;  ///< its `materials` begin with those of the context, in the same order
  std::uint32_t neighbours =
      0;                ///< > 0: the host joins each mass to this many nearest masses by springs of their mean material
  std::string failure;  ///< reason why there is no body; empty if there is one
  std::vector<Vec3> paired_at = {};  ///< positions, one for each mass, from which the nearest masses are determined;
                                     ///< empty: the rest positions
  std::vector<Vec3> origins = {};  ///< the point that the encoding mapped to each mass, for pictures; empty: no points
  /// What masses remember at birth: a number for each mass by name. Devo operators take those that they have declared
  /// under the same name (Devo::mass_memory).
  std::map<std::string, std::vector<double>> mass_memory = {};
  /// Likewise what springs remember: a number for each spring of `body` by name (Devo::spring_memory). Only names that
  /// Encoding::spring_memory() declares may be given.
  std::map<std::string, std::vector<double>> spring_memory = {};
  /// Identities of the masses (DevoContext::identity()), all different; empty: the indices in `body`. To be given if
  /// the same mass can have another index in a relative.
  std::vector<std::uint64_t> identities = {};
  bool parallel = false;  ///< whether several springs may join the same pair of masses; otherwise, this is an error
};

class Encoding : public Operator {
 public:
  static constexpr std::string_view kind = "encoding";

  /// Declares the genes of the encoding: its section of all genomes of the experiment.
  virtual Layout layout(const EncodingContext& context) const = 0;
  /// Returns its genes for a first genome, one without ancestors.
  virtual Genome random(const Layout& layout, Rng& rng) const { return random_genome(layout, rng); }
  /// Turns a genome into a blueprint, or into the reason why there is no body (Blueprint::failure). `layout` is what
  /// layout() returned.
  virtual Blueprint decode(const Genome& genome, const Layout& layout, const EncodingContext& context) const = 0;
  /// Completes a blueprint whose `neighbours` the host has joined. Springs have the distance of the rest positions for
  /// rest length, and the mean material of their masses, and remember 0 under the names that decode() has used; the
  /// encoding may change this, give springs other memory, or set Blueprint::failure. It must not add or remove masses
  /// or springs.
  virtual void joined([[maybe_unused]] Blueprint& blueprint) const {}
  /// Returns the names of what decode() or joined() give springs to remember (Blueprint::spring_memory).
  virtual std::vector<std::string> spring_memory() const { return {}; }
};

}  // namespace evodevo
