// The paper's computed materials (section V): a spring carries its material as a short code that a GPU decodes. The
// code rounds the material; the CPU simulates the rounded material too.
//
//   body ─► material_units ─► code_of (each spring's material) ─► material_of (the rounded material)
#pragma once

#include <vector>

#include "core/simulator.hpp"
#include "evodevo/body.hpp"
#include "physics/material_code.hpp"

namespace evodevo {

/// The units of the numbers in a body's codes.
struct MaterialUnits {
  double stiffness = 0;  ///< N/m
  double amplitude = 0;  ///< 1
  double frequency = 0;  ///< Hz
};

/// The units in which the largest stiffness, amplitude and frequency among a body's springs are 65,520, 1,020 and
/// 1,020. These numbers have many divisors, so that means of materials, and materials in simple proportion to the
/// largest, are represented exactly.
MaterialUnits material_units(const Body& body);

/// The nearest code of a material that a spring of the body has. Each number is rounded by at most half a unit, the
/// phase by at most 1/8,192 of a turn. A stiffness above zero is at least one unit, so that no spring loses its force.
MaterialCode code_of(const Material& material, const MaterialUnits& units);

/// The material that a code stands for.
Material material_of(const MaterialCode& code, const MaterialUnits& units);

/// The materials with which a body is simulated: rounded if `way` is Materials::computed. Materials that no spring has
/// stay as they are.
std::vector<Material> simulated_materials(const Body& body, Materials way);

}  // namespace evodevo
