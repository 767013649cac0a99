// The materials of a body, each once.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "evodevo/body.hpp"

namespace evodevo {

/// The same of materials that are equal, whatever the signs of their zeros.
struct MaterialHash {
  std::size_t operator()(const Material& material) const;
};

using MaterialNumbers = std::unordered_map<Material, std::uint32_t, MaterialHash>;

/// The index of each material, of equal ones that of the first.
MaterialNumbers numbered(const std::vector<Material>& materials);

/// Finds materials in a list, and adds to it, without looking through all of it. Nobody else may change the list.
class MaterialList {
 public:
  explicit MaterialList(std::vector<Material>& materials) : materials_(materials), numbers_(numbered(materials)) {}

  /// The index of a material in the list, to which it is appended if it is new.
  std::uint32_t index(const Material& material);

 private:
  std::vector<Material>& materials_;
  MaterialNumbers numbers_;
};

/// Removes from a body every material that no spring and no mass uses, and every duplicate of an earlier material. The
/// body's base materials stay.
void drop_unused_materials(Body& body);

}  // namespace evodevo
