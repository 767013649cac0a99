#include "cpu/coloured_springs.hpp"

#include <algorithm>

#include "analysis/colouring.hpp"

namespace evodevo::cpu {
namespace {

/// The indices of the springs of each colour, in the body's order.
std::vector<std::vector<std::uint32_t>> by_colour(const Body& body) {
  std::vector<std::vector<std::uint32_t>> springs;
  const std::vector<std::uint32_t> colours = spring_colours(body);
  for (std::uint32_t i = 0; i < colours.size(); ++i) {
    if (colours[i] >= springs.size()) springs.resize(colours[i] + 1);
    springs[colours[i]].push_back(i);
  }
  return springs;
}

/// The inverse of a mass (kg), 1/kg; 0 for a mass of 0 kg, which never moves.
double inverse(double mass) { return mass > 0 ? 1 / mass : 0; }

}  // namespace

template <class T>
ColouredSprings<T>::ColouredSprings(const Body& body, const Layout<T>& layout) {
  const auto colours = by_colour(body);
  const auto filled_up = [&](std::size_t count) { return (count + layout.lanes - 1) / layout.lanes * layout.lanes; };
  for (const auto& springs : colours) size += filled_up(springs.size());
  for (auto* offsets : {&a, &b, &slot}) *offsets = Array<std::uint32_t>(size);
  for (auto* numbers : {&stiffness, &rest_length, &inverse_mass_a, &inverse_mass_b}) *numbers = Array<T>(size);
  material = Array<Index<T>>(size);
  if (layout.damping.size() > 0) damping = Array<T>(size);

  std::vector<std::uint32_t> index_of(layout.masses);
  for (std::uint32_t index = 0; index < layout.masses; ++index) index_of[layout.mass_at[index]] = index;
  std::size_t first = 0;
  for (const auto& springs : colours) {
    std::size_t at = first;
    for (const std::uint32_t i : springs) {
      const Spring& spring = body.springs[i];
      a[at] = static_cast<std::uint32_t>(position_stride * index_of[spring.a]);
      b[at] = static_cast<std::uint32_t>(position_stride * index_of[spring.b]);
      slot[at] = layout.slot_of[i];
      stiffness[at] = static_cast<T>(body.stiffness(spring));
      rest_length[at] = static_cast<T>(spring.rest_length);
      if (damping.size() > 0) damping[at] = static_cast<T>(body.damping(spring));
      inverse_mass_a[at] = static_cast<T>(inverse(body.masses[spring.a].mass));
      inverse_mass_b[at] = static_cast<T>(inverse(body.masses[spring.b].mass));
      material[at] = static_cast<Index<T>>(spring.material);
      ++at;
    }
    first += filled_up(springs.size());
  }
}

template struct ColouredSprings<float>;
template struct ColouredSprings<double>;

}  // namespace evodevo::cpu
