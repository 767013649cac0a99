// For tests of regulated-growth: networks with single weights, and a body in which all masses feel something else.
#pragma once

#include <algorithm>
#include <stdexcept>

#include "life.hpp"

namespace evodevo::test {

/// Limits that hold no mass back, except that only one mass takes each action.
inline constexpr const char* one_act =
    "actions = 1\nleast_springs = 1\nmost_springs = 20\nmin_distance = 0.0\nlow = 1.0\nhigh = 1e6";

/// A weight of the network, from an input to an output.
struct Weight {
  std::string to, from;
  float value;
};

/// Returns genes in which all weights are 0 except the given ones.
inline Genome genes(const Devo& devo, const std::vector<Weight>& weights) {
  const Layout layout = devo.layout(context());
  Genome genome(layout.first_size());
  for (const Weight& weight : weights) {
    const auto block = std::find_if(layout.first_blocks.begin(), layout.first_blocks.end(),
                                    [&](const Block& one) { return layout.types[one.type].name == weight.to; });
    const auto& names = layout.types.at(block->type).gene_names;
    const auto gene = std::find(names.begin(), names.end(), weight.from);
    if (gene == names.end()) throw std::runtime_error("no input " + weight.from);
    genome.genes.at(block->first + static_cast<std::size_t>(gene - names.begin())) = weight.value;
  }
  return genome;
}

/// A life of 12 masses and 26 springs, in which no two masses feel the same.
inline Life varied_life() {
  Life life = life_of_masses(12, false);
  Rng rng = stream(5);
  std::set<Pair> pairs;
  for (std::uint32_t i = 0; i < 12; ++i) pairs.insert(ordered(i, (i + 1) % 12));
  while (pairs.size() < 26) {
    const std::uint32_t a = rng.below(12), b = rng.below(12);
    if (a != b) pairs.insert(ordered(a, b));
  }
  for (const auto& [a, b] : pairs)
    life.add_spring(a, b, life.living.body.springs.size() % 2 ? muscle : bone, rng.uniform(1, 100));
  for (std::uint32_t i = 0; i < 12; ++i) {
    life.contact.push_back(rng.uniform());
    life.age.push_back(100 * rng.uniform());
    life.mass_memory().insert(life.mass_memory().end(), {rng.uniform(-1, 1), rng.uniform(-1, 1)});
  }
  return life;
}

}  // namespace evodevo::test
