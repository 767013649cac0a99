#include "analysis/split_materials.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

namespace evodevo {
namespace {

/// The coefficient of a spring's dashpot, N s/m. Most bodies have none, and then no root is computed.
double dashpot_of(const Body& body, const Spring& spring) {
  return body.materials[spring.material].damping != 0 ? body.damping(spring) : 0;
}

/// Whether all springs of a material agree, and none has a stiffness factor.
bool agree(const Body& body) {
  const auto has_factor = [](const Spring& spring) { return spring.stiffness_factor != 1; };
  if (std::ranges::all_of(body.materials, [](const Material& material) { return material.damping == 0; }))
    return std::ranges::none_of(body.springs, has_factor);
  std::vector<std::optional<double>> dashpots(body.materials.size());
  return std::all_of(body.springs.begin(), body.springs.end(), [&](const Spring& spring) {
    if (has_factor(spring)) return false;
    const double dashpot = dashpot_of(body, spring);
    std::optional<double>& first = dashpots[spring.material];
    if (!first) first = dashpot;
    return *first == dashpot;
  });
}

}  // namespace

std::unique_ptr<const Body> split_materials(const Body& body) {
  if (agree(body)) return nullptr;
  auto split = std::make_unique<Body>(body);
  std::vector<bool> taken(body.materials.size());  // whether a material's own number belongs to a combination
  std::map<std::tuple<std::uint32_t, double, double>, std::uint32_t> made;
  for (Spring& spring : split->springs) {
    const auto next = static_cast<std::uint32_t>(split->materials.size());
    const auto [found, is_new] =
        made.try_emplace({spring.material, spring.stiffness_factor, dashpot_of(body, spring)}, next);
    if (is_new && spring.stiffness_factor == 1 && !taken[spring.material]) {
      taken[spring.material] = true;
      found->second = spring.material;
    } else if (is_new) {
      Material material = body.materials[spring.material];
      material.stiffness = body.stiffness(spring);
      split->materials.push_back(material);
    }
    spring.material = found->second;
    spring.stiffness_factor = 1;
  }
  return split;
}

SplitMaterials::SplitMaterials(std::span<Task> tasks, Workers& workers) : tasks_(tasks), split_(tasks.size()) {
  for (const Task& task : tasks) given_.push_back(task.body);
  workers.for_each(tasks.size(), [&](std::size_t i) {
    split_[i] = split_materials(*given_[i]);
    if (split_[i]) tasks_[i].body = split_[i].get();
  });
}

SplitMaterials::~SplitMaterials() {
  for (std::size_t i = 0; i < tasks_.size(); ++i) tasks_[i].body = given_[i];
}

std::vector<double> dashpot_coefficients(const Body& body, std::span<const Material> materials) {
  std::vector<double> coefficients(materials.size());
  std::vector<bool> known(materials.size());
  for (const Spring& spring : body.springs) {
    if (known[spring.material]) continue;
    known[spring.material] = true;
    const double dashpot = dashpot_of(body, spring);
    if (dashpot == 0) continue;
    coefficients[spring.material] = dashpot * std::sqrt(materials[spring.material].stiffness / body.stiffness(spring));
  }
  return coefficients;
}

}  // namespace evodevo
