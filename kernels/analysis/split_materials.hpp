// Bodies for kernels that take everything about a spring but its rest length from its material: there, all springs of a
// material have the same stiffness and the same dashpot.
#pragma once

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
std::unique_ptr<const Body> split_materials(const Body& body);

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
  std::vector<std::unique_ptr<const Body>> split_;  ///< null where the given body needs no other
};

/// Returns the coefficient of the dashpot of each material of a body whose springs agree (N s/m), with the stiffness of
/// `materials`, which may be rounded; 0 for materials that no spring has.
std::vector<double> dashpot_coefficients(const Body& body, std::span<const Material> materials);

}  // namespace evodevo
