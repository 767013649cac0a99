// The paper's computed material (section V): a spring carries its material as a short code that a GPU decodes. What a
// code can say of a material, the CPU simulates as well.
#pragma once

#include <vector>

#include "core/simulator.hpp"
#include "evodevo/body.hpp"
#include "physics/material_code.hpp"

namespace evodevo {

/// What the numbers in a body's codes count.
struct MaterialUnits {
  double stiffness = 0;  ///< N/m
  double amplitude = 0;  ///< 1
  double frequency = 0;  ///< Hz
};

/// The units in which the largest stiffness, amplitude and frequency of a body's springs are 65,520, 1,020 and 1,020:
/// numbers that many others divide, so that means of materials, and all that is in simple proportion to the largest,
/// have codes.
MaterialUnits material_units(const Body& body);

/// The nearest code of a material that a spring of the body has: off by half a unit at most, but for a stiffness of
/// less than half a unit that is not 0, which is one; and by half a 4,096th of a turn of phase.
MaterialCode code_of(const Material& material, const MaterialUnits& units);

Material material_of(const MaterialCode& code, const MaterialUnits& units);

/// The materials that a body is simulated with; those that no spring has are as they were.
std::vector<Material> simulated_materials(const Body& body, Materials way);

}  // namespace evodevo
