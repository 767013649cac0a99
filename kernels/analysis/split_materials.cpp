#include "analysis/split_materials.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

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

std::unique_ptr<Body> split_materials(const Body& body) {
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

SplitBody::SplitBody(const Body& given, Body split)
    : split_(std::move(split)), given_materials_(given.materials), given_(split_.materials.size()) {
  for (std::size_t i = 0; i < given.springs.size(); ++i)
    given_[split_.springs[i].material] = {given.springs[i].material, given.springs[i].stiffness_factor};
}

std::shared_ptr<SplitBody> SplitBody::of(const Body& body, std::shared_ptr<SplitBody> earlier) {
  // lives that are copies of each other may share one, which then stays as it is
  if (earlier.use_count() == 1 && earlier->follow(body)) return earlier;
  const std::unique_ptr<Body> split = split_materials(body);
  return split ? std::shared_ptr<SplitBody>(new SplitBody(body, std::move(*split))) : nullptr;
}

bool SplitBody::follow(const Body& body) {
  const auto weighs = [](const Mass& now, const Mass& before) { return now.mass == before.mass; };
  if (body.springs.size() != split_.springs.size() || body.materials != given_materials_ ||
      !std::ranges::equal(body.masses, split_.masses, weighs))
    return false;
  for (std::size_t i = 0; i < body.springs.size(); ++i) {
    const Spring& now = body.springs[i];
    Spring& split = split_.springs[i];
    const Given& given = given_[split.material];
    if (now.a != split.a || now.b != split.b || now.material != given.material ||
        now.stiffness_factor != given.stiffness_factor)
      return false;
    split.rest_length = now.rest_length;
  }
  split_.masses = body.masses;
  return true;
}

SplitMaterials::SplitMaterials(std::span<Task> tasks, Workers& workers) : tasks_(tasks) {
  for (const Task& task : tasks) given_.push_back(task.body);
  workers.for_each(tasks.size(), [&](std::size_t i) {
    Task& task = tasks_[i];
    task.split = SplitBody::of(*given_[i], std::move(task.split));
    if (task.split) task.body = &task.split->body();
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
