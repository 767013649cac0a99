#include "analysis/computed_materials.hpp"

#include <algorithm>
#include <cmath>

namespace evodevo {
namespace {

constexpr std::uint32_t phases = 1u << (32 - phase_shift);  // number of phases in a full turn
constexpr double most_stiffness = 65'520, most_amplitude = 1'020, most_frequency = 1'020;

/// The nearest whole number to one that is not negative; much faster than std::lround().
std::uint32_t rounded(double value) { return static_cast<std::uint32_t>(value + 0.5); }

std::uint32_t counted(double value, double unit) { return unit > 0 ? rounded(std::abs(value) / unit) : 0; }

/// The phase (rad) that gives the same motion when amplitude and frequency are replaced by their absolute values.
double phase_of(const Material& material) {
  const double phase = material.frequency < 0 ? full_turn / 2 - material.phase : material.phase;
  return material.amplitude < 0 ? phase + full_turn / 2 : phase;
}

}  // namespace

MaterialUnits material_units(const Body& body) {
  MaterialUnits largest;
  for (const Spring& spring : body.springs) {
    const Material& material = body.materials[spring.material];
    largest.stiffness = std::max(largest.stiffness, material.stiffness);
    largest.amplitude = std::max(largest.amplitude, std::abs(material.amplitude));
    largest.frequency = std::max(largest.frequency, std::abs(material.frequency));
  }
  return {largest.stiffness / most_stiffness, largest.amplitude / most_amplitude, largest.frequency / most_frequency};
}

MaterialCode code_of(const Material& material, const MaterialUnits& units) {
  const double turns = phase_of(material) / full_turn;
  // a phase that rounds up to a whole turn is phase 0
  const std::uint32_t phase = rounded((turns - std::floor(turns)) * phases) % phases;
  const std::uint32_t least = material.stiffness > 0 ? 1 : 0;  // no spring loses its force
  return {std::max(least, counted(material.stiffness, units.stiffness)),
          phase << phase_shift | counted(material.amplitude, units.amplitude) << amplitude_shift |
              counted(material.frequency, units.frequency)};
}

Material material_of(const MaterialCode& code, const MaterialUnits& units) {
  return {code.stiffness * units.stiffness, ((code.wave & amplitude_mask) >> amplitude_shift) * units.amplitude,
          (code.wave & frequency_mask) * units.frequency, (code.wave >> phase_shift) * (full_turn / phases)};
}

CodedMaterials::CodedMaterials(const Body& body) : units(material_units(body)), codes(body.materials.size()) {
  std::vector<bool> known(codes.size());
  for (const Spring& spring : body.springs) {
    if (known[spring.material]) continue;
    known[spring.material] = true;
    codes[spring.material] = code_of(body.materials[spring.material], units);
  }
}

std::vector<Material> rounded_materials(const Body& body, const CodedMaterials& coded) {
  std::vector<Material> rounded = body.materials;
  for (std::size_t i = 0; i < rounded.size(); ++i) {
    if (coded.codes[i].stiffness == 0) continue;  // springs have at least one unit of stiffness
    rounded[i] = material_of(coded.codes[i], coded.units);
    rounded[i].damping = body.materials[i].damping;
  }
  return rounded;
}

std::vector<Material> simulated_materials(const Body& body, Materials way) {
  return way == Materials::table ? body.materials : rounded_materials(body, CodedMaterials(body));
}

}  // namespace evodevo
