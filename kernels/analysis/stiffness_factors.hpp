// Springs whose stiffness differs from that of their material, for kernels that take stiffness from materials alone.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/simulator.hpp"
#include "evodevo/body.hpp"
#include "threads/parallel.hpp"

namespace evodevo {

/// Returns the same body without stiffness factors: it has a further material for each pair of a material and a factor
/// other than 1. Returns nothing if no spring has such a factor.
std::unique_ptr<const Body> without_factors(const Body& body);

/// While this object exists, tasks have bodies without stiffness factors.
class WithoutFactors {
 public:
  WithoutFactors(std::span<Task> tasks, Workers& workers);
  ~WithoutFactors();
  WithoutFactors(const WithoutFactors&) = delete;
  WithoutFactors& operator=(const WithoutFactors&) = delete;

 private:
  std::span<Task> tasks_;
  std::vector<const Body*> given_;
  std::vector<std::unique_ptr<const Body>> plain_;  ///< null where the given body has no factors
};

}  // namespace evodevo
