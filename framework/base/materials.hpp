// Lists of materials without duplicates.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "evodevo/body.hpp"

namespace evodevo {

/// Hash of a material. Equal materials have equal hashes, even if one has 0 where the other has -0.
struct MaterialHash {
  std::size_t operator()(const Material& material) const;
};

using MaterialNumbers = std::unordered_map<Material, std::uint32_t, MaterialHash>;

/// Returns the index of each material. Equal materials share the index of the first of them.
MaterialNumbers numbered(const std::vector<Material>& materials);

/// Finds and adds materials in a list by hashing, without a linear search. While this object exists, nothing else may
/// change the list.
class MaterialList {
 public:
  explicit MaterialList(std::vector<Material>& materials) : materials_(materials), numbers_(numbered(materials)) {}

  /// Returns the index of a material in the list. Appends the material if the list does not have it.
  std::uint32_t index(const Material& material);

 private:
  std::vector<Material>& materials_;
  MaterialNumbers numbers_;
};

/// Removes from a body every material that no spring and no mass uses, and every duplicate of an earlier material. The
/// body's base materials stay.
void drop_unused_materials(Body& body);

}  // namespace evodevo
