#include "paper/paper_layout.hpp"

#include <algorithm>

#include "analysis/ground.hpp"
#include "cuda/layout/answers.hpp"

namespace evodevo::tools::bench {

PaperLayout::PaperLayout(std::span<const Body> originals, std::uint32_t copies, const Scene& scene, SpringOrder order) {
  for (const Body& body : originals) {
    const State birth = state_at_birth(body, scene);
    const std::vector<std::uint32_t> springs_in_order = ordered_springs(body, order);
    const auto first_entry = static_cast<std::uint32_t>(actuators.size());
    for (const Material& material : body.materials) actuators.push_back(cuda::actuator_of(material, 1));
    for (std::uint32_t copy = 0; copy < copies; ++copy) append(body, birth, springs_in_order, first_entry);
  }
}

void PaperLayout::append(const Body& body, const State& birth, std::span<const std::uint32_t> order,
                         std::uint32_t first_entry) {
  const PaperBody place{static_cast<std::uint32_t>(positions.size()), static_cast<std::uint32_t>(body.masses.size()),
                        static_cast<std::uint32_t>(springs.size()), static_cast<std::uint32_t>(body.springs.size())};
  bodies.push_back(place);
  most_masses = std::max(most_masses, place.masses);
  most_springs = std::max(most_springs, place.springs);
  for (std::size_t i = 0; i < body.masses.size(); ++i) {
    const double kilograms = body.masses[i].mass;
    mass.push_back(static_cast<float>(kilograms));
    inverse_mass.push_back(static_cast<float>(kilograms > 0 ? 1 / kilograms : 0));
    const Vec3 at = birth.position[i];
    positions.push_back({static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z), 0});
  }
  for (const std::uint32_t i : order) {
    const Spring& spring = body.springs[i];
    springs.push_back({spring.a, spring.b, static_cast<float>(spring.rest_length), first_entry + spring.material});
  }
}

}  // namespace evodevo::tools::bench
