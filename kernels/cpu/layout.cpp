#include "cpu/layout.hpp"

#include <algorithm>
#include <numeric>
#include <span>
#include <tuple>

namespace evodevo::cpu {
namespace {

/// The springs at each mass: those of mass i are `spring[first[i]] .. spring[first[i + 1] - 1]`, in ascending order.
struct Incidence {
  explicit Incidence(const Body& body) : first(body.masses.size() + 1), spring(2 * body.springs.size()) {
    for (const Spring& s : body.springs) ++first[s.a + 1], ++first[s.b + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (std::uint32_t i = 0; i < body.springs.size(); ++i) {
      spring[next[body.springs[i].a]++] = i;
      spring[next[body.springs[i].b]++] = i;
    }
  }

  std::uint32_t degree(std::uint32_t mass) const { return first[mass + 1] - first[mass]; }
  std::span<const std::uint32_t> of(std::uint32_t mass) const { return {spring.data() + first[mass], degree(mass)}; }

  std::vector<std::uint32_t> first, spring;
};

/// The indices of the masses in descending order of degree; masses of equal degree in ascending order of index.
std::vector<std::uint32_t> sorted_masses(const Incidence& incidence, std::size_t masses) {
  std::vector<std::uint32_t> order(masses);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return incidence.degree(a) > incidence.degree(b); });
  return order;
}

}  // namespace

template <class T>
Layout<T>::Layout(const Body& body, std::size_t lanes_)
    : lanes(lanes_),
      masses(body.masses.size()),
      springs(body.springs.size()),
      groups((masses + lanes - 1) / lanes),
      slot_of(springs),
      first_row(groups + 1) {
  const Incidence incidence(body);
  mass_at = sorted_masses(incidence, masses);
  std::vector<std::uint32_t> index_of(masses);
  for (std::uint32_t index = 0; index < masses; ++index) index_of[mass_at[index]] = index;
  // the first mass of a group has its highest degree
  for (std::size_t g = 0; g < groups; ++g) first_row[g + 1] = first_row[g] + incidence.degree(mass_at[g * lanes]);

  neighbour = Array<std::uint32_t>(slots() + lanes);  // the loop over rows reads one row ahead
  stiffness = Array<T>(slots());
  rest_length = Array<T>(slots());
  const auto has_dashpot = [&](const Spring& spring) { return body.materials[spring.material].damping != 0; };
  if (std::any_of(body.springs.begin(), body.springs.end(), has_dashpot)) damping = Array<T>(slots());
  material = Array<Index<T>>(slots());
  for (std::size_t g = 0; g < groups; ++g)
    for (std::size_t slot = first_row[g] * lanes; slot < first_row[g + 1] * lanes; ++slot)
      neighbour[slot] = static_cast<std::uint32_t>(position_stride * (g * lanes + slot % lanes));
  for (std::uint32_t index = 0; index < masses; ++index) {
    std::size_t slot = first_row[index / lanes] * lanes + index % lanes;
    for (const std::uint32_t i : incidence.of(mass_at[index])) {
      const Spring& spring = body.springs[i];
      const std::uint32_t other = spring.a == mass_at[index] ? spring.b : spring.a;
      neighbour[slot] = static_cast<std::uint32_t>(position_stride * index_of[other]);
      stiffness[slot] = static_cast<T>(body.stiffness(spring));
      rest_length[slot] = static_cast<T>(spring.rest_length);
      if (damping.size() > 0) damping[slot] = static_cast<T>(body.damping(spring));
      material[slot] = static_cast<Index<T>>(spring.material);
      slot_of[i] = static_cast<std::uint32_t>(slot);
      slot += lanes;
    }
  }
}

template struct Layout<float>;
template struct Layout<double>;

}  // namespace evodevo::cpu
