#include "analysis/colouring.hpp"

#include <algorithm>
#include <numeric>

namespace evodevo {
namespace {

/// The indices of the springs in descending order of the sum of their two masses' degrees.
std::vector<std::uint32_t> most_connected_first(const Body& body) {
  std::vector<std::uint32_t> degree(body.masses.size()), order(body.springs.size());
  for (const Spring& spring : body.springs) ++degree[spring.a], ++degree[spring.b];
  const auto connections = [&](std::uint32_t i) { return degree[body.springs[i].a] + degree[body.springs[i].b]; };
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t i, std::uint32_t j) { return connections(i) > connections(j); });
  return order;
}

/// The set of colours of the springs at one mass.
class Palette {
 public:
  bool has(std::uint32_t colour) const { return colour < used_.size() && used_[colour]; }
  void add(std::uint32_t colour) {
    if (colour >= used_.size()) used_.resize(colour + 1);
    used_[colour] = true;
  }

 private:
  std::vector<bool> used_;
};

}  // namespace

std::vector<std::uint32_t> spring_colours(const Body& body) {
  std::vector<std::uint32_t> colours(body.springs.size());
  std::vector<Palette> at(body.masses.size());
  for (const std::uint32_t i : most_connected_first(body)) {
    Palette &a = at[body.springs[i].a], &b = at[body.springs[i].b];
    std::uint32_t colour = 0;
    while (a.has(colour) || b.has(colour)) ++colour;
    a.add(colour);
    b.add(colour);
    colours[i] = colour;
  }
  return colours;
}

}  // namespace evodevo
