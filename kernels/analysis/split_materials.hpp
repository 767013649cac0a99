// Bodies for kernels that take everything about a spring but its rest length from its material: there, all springs of a
// material have the same stiffness and the same dashpot.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/simulator.hpp"
#include "evodevo/body.hpp"
#include "threads/parallel.hpp"

namespace evodevo {

/// Returns the same body without stiffness factors and with a further material for each combination of a material, a
/// stiffness factor and a coefficient of the dashpot, so that all springs of a material agree in these. Returns nothing
/// if that is so already.
std::unique_ptr<Body> split_materials(const Body& body);

/// The result of split_materials() for a body that changes, such as that of a life: it follows changes of lengths and
/// places, which is much faster than another split.
class SplitBody {
 public:
  /// Returns null if the springs of each material agree in the given body. `earlier`: the split body before the given
  /// body changed, or null.
  static std::shared_ptr<SplitBody> of(const Body& body, std::shared_ptr<SplitBody> earlier);

  const Body& body() const { return split_; }

 private:
  /// Of which springs of the given body a material of the split body is.
  struct Given {
    std::uint32_t material = 0;
    double stiffness_factor = 1;
  };

  SplitBody(const Body& given, Body split);
  bool follow(const Body& body);

  Body split_;
  std::vector<Material> given_materials_;
  std::vector<Given> given_;  ///< for each material of the split body
};

/// While this object exists, the springs of a material agree in all bodies of the tasks.
class SplitMaterials {
 public:
  SplitMaterials(std::span<Task> tasks, Workers& workers);
  ~SplitMaterials();
  SplitMaterials(const SplitMaterials&) = delete;
  SplitMaterials& operator=(const SplitMaterials&) = delete;

 private:
  std::span<Task> tasks_;
  std::vector<const Body*> given_;
};

/// Returns the coefficient of the dashpot of each material of a body whose springs agree (N s/m), with the stiffness of
/// `materials`, which may be rounded; 0 for materials that no spring has.
std::vector<double> dashpot_coefficients(const Body& body, std::span<const Material> materials);

}  // namespace evodevo
