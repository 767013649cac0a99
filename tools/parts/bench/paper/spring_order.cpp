#include "paper/spring_order.hpp"

#include <algorithm>
#include <list>
#include <numeric>
#include <random>

namespace evodevo::tools::bench {
namespace {

constexpr std::size_t threads_of_a_warp = 32;

void shuffle(std::vector<std::uint32_t>& items) {
  std::mt19937_64 random(1);
  for (std::size_t left = items.size(); left > 1; --left) std::swap(items[left - 1], items[random() % left]);
}

/// Fills one warp after the other. Each place goes to the first remaining spring that shares no mass with the springs
/// already in the warp, or, if there is no such spring, to the first remaining one.
std::vector<std::uint32_t> spread(const Body& body, const std::vector<std::uint32_t>& springs) {
  std::list<std::uint32_t> left(springs.begin(), springs.end());
  std::vector<std::uint32_t> result;
  std::vector<std::size_t> warp_of_mass(body.masses.size());  // last warp with a spring of this mass, counted from 1
  while (!left.empty()) {
    const std::size_t warp = result.size() / threads_of_a_warp + 1;
    auto next = std::find_if(left.begin(), left.end(), [&](std::uint32_t i) {
      return warp_of_mass[body.springs[i].a] != warp && warp_of_mass[body.springs[i].b] != warp;
    });
    if (next == left.end()) next = left.begin();
    warp_of_mass[body.springs[*next].a] = warp_of_mass[body.springs[*next].b] = warp;
    result.push_back(*next);
    left.erase(next);
  }
  return result;
}

}  // namespace

std::string name(SpringOrder order) {
  switch (order) {
    case SpringOrder::as_built:
      return "as built";
    case SpringOrder::by_first_mass:
      return "by first mass";
    case SpringOrder::shuffled:
      return "shuffled";
    case SpringOrder::spread:
      return "spread";
  }
  return "?";
}

std::vector<std::uint32_t> ordered_springs(const Body& body, SpringOrder order) {
  std::vector<std::uint32_t> springs(body.springs.size());
  std::iota(springs.begin(), springs.end(), 0u);
  if (order == SpringOrder::by_first_mass)
    std::stable_sort(springs.begin(), springs.end(),
                     [&](std::uint32_t i, std::uint32_t j) { return body.springs[i].a < body.springs[j].a; });
  if (order == SpringOrder::shuffled || order == SpringOrder::spread) shuffle(springs);
  return order == SpringOrder::spread ? spread(body, springs) : springs;
}

}  // namespace evodevo::tools::bench
