#include "analysis/stiffness_factors.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace evodevo {

std::unique_ptr<const Body> without_factors(const Body& body) {
  const auto has_factor = [](const Spring& spring) { return spring.stiffness_factor != 1; };
  if (std::none_of(body.springs.begin(), body.springs.end(), has_factor)) return nullptr;
  auto plain = std::make_unique<Body>(body);
  std::map<std::pair<std::uint32_t, double>, std::uint32_t> made;
  for (Spring& spring : plain->springs) {
    if (!has_factor(spring)) continue;
    const auto next = static_cast<std::uint32_t>(plain->materials.size());
    const auto [found, is_new] = made.try_emplace({spring.material, spring.stiffness_factor}, next);
    if (is_new) {
      Material material = plain->materials[spring.material];
      material.stiffness = body.stiffness(spring);
      plain->materials.push_back(material);
    }
    spring.material = found->second;
    spring.stiffness_factor = 1;
  }
  return plain;
}

WithoutFactors::WithoutFactors(std::span<Task> tasks, Workers& workers) : tasks_(tasks), plain_(tasks.size()) {
  for (const Task& task : tasks) given_.push_back(task.body);
  workers.for_each(tasks.size(), [&](std::size_t i) {
    plain_[i] = without_factors(*given_[i]);
    if (plain_[i]) tasks_[i].body = plain_[i].get();
  });
}

WithoutFactors::~WithoutFactors() {
  for (std::size_t i = 0; i < tasks_.size(); ++i) tasks_[i].body = given_[i];
}

}  // namespace evodevo
