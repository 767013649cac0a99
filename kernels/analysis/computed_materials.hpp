// The paper's computed materials (section V): a spring carries its material as a short code that a GPU decodes. The
// code rounds the material; the CPU simulates the rounded material too.
//
//   body ─► material_units ─► code_of (the material of a spring) ─► material_of (the rounded material)
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

/// The code that is closest to a material of one of the body's springs. Rounding changes each number by at most half a
/// unit, and the phase by at most 1/8,192 of a turn. A stiffness above zero is encoded as at least one unit, so that no
/// spring loses its force.
MaterialCode code_of(const Material& material, const MaterialUnits& units);

/// The material that a code represents.
Material material_of(const MaterialCode& code, const MaterialUnits& units);

/// The codes of the materials of a body's springs.
struct CodedMaterials {
  CodedMaterials() = default;
  explicit CodedMaterials(const Body& body);

  MaterialUnits units;
  std::vector<MaterialCode> codes;  ///< of each material of the body; 0 for those that no spring has
};

/// The materials of a body after rounding; those that no spring has are unchanged.
std::vector<Material> rounded_materials(const Body& body, const CodedMaterials& coded);

/// The materials with which a body is simulated: those of springs are rounded if `way` is Materials::computed;
/// materials that no spring has are unchanged.
std::vector<Material> simulated_materials(const Body& body, Materials way);

}  // namespace evodevo
