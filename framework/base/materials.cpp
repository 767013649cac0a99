#include "base/materials.hpp"

#include <algorithm>
#include <boost/container_hash/hash.hpp>
#include <functional>
#include <ranges>

namespace evodevo {

std::size_t MaterialHash::operator()(const Material& material) const {
  std::size_t hash = 0;
  for (const double value :
       {material.stiffness, material.amplitude, material.frequency, material.phase, material.damping})
    boost::hash_combine(hash, std::hash<double>()(value));  // equal for 0 and -0
  return hash;
}

MaterialNumbers numbered(const std::vector<Material>& materials) {
  MaterialNumbers numbers;
  numbers.reserve(materials.size());
  for (std::uint32_t i = 0; i < materials.size(); ++i) numbers.try_emplace(materials[i], i);
  return numbers;
}

std::uint32_t MaterialList::index(const Material& material) {
  const auto [found, is_new] = numbers_.try_emplace(material, static_cast<std::uint32_t>(materials_.size()));
  if (is_new) materials_.push_back(material);
  return found->second;
}

namespace {

/// Marks the materials that springs or masses use. Base materials are marked in any case.
std::vector<std::uint8_t> used_materials(const Body& body) {
  std::vector<std::uint8_t> used(body.materials.size(), 0);
  std::fill_n(used.begin(), body.base_materials, 1);
  std::size_t unused = used.size() - body.base_materials;
  const auto use = [&](std::size_t material) { unused -= used[material] == 0, used[material] = 1; };
  for (const Mass& mass : body.masses)
    if (mass.material != no_material) use(static_cast<std::size_t>(mass.material));
  for (auto spring = body.springs.begin(); spring != body.springs.end() && unused > 0; ++spring) use(spring->material);
  return used;
}

}  // namespace

void drop_unused_materials(Body& body) {
  const std::vector<std::uint8_t> used = used_materials(body);
  std::vector<Material> kept(body.materials.begin(), body.materials.begin() + body.base_materials);
  MaterialList list(kept);
  std::vector<std::uint32_t> new_index;
  for (std::uint32_t i = 0; i < body.materials.size(); ++i) {
    const bool is_base = i < body.base_materials;
    new_index.push_back(is_base || !used[i] ? i : list.index(body.materials[i]));
  }
  body.materials = std::move(kept);
  if (std::ranges::equal(new_index, std::views::iota(0u, static_cast<std::uint32_t>(new_index.size())))) return;
  for (Spring& spring : body.springs) spring.material = new_index[spring.material];
  for (Mass& mass : body.masses)
    if (mass.material != no_material)
      mass.material = static_cast<std::int32_t>(new_index[static_cast<std::size_t>(mass.material)]);
}

}  // namespace evodevo
