// Networks whose nodes and links come and go (NEAT: Stanley and Miikkulainen 2002): the types of blocks by which an
// encoding and the mutations of its topology understand each other.
#pragma once

#include <optional>

#include "evodevo/blocks.hpp"

namespace evodevo::neat {

/// Positions of the genes of a node: its bias and the index of its activation function.
enum NodeGene : std::uint32_t { bias, function };
/// Positions of the genes of a link: its weight, whether it is on (1) or off (0), and the nodes that it joins.
enum LinkGene : std::uint32_t { weight, on, from, to };

/// Indices of the two types of blocks in a layout.
struct Types {
  std::uint32_t node = 0, link = 0;
};

/// Adds both types to a layout. Weights and biases are in [-range, range]; `functions` has the names of the activation
/// functions that a node may have; a genome has at most `nodes` nodes, inputs and outputs included, and `links` links.
inline Types add_types(Layout& layout, float range, std::vector<std::string> functions, std::uint32_t nodes,
                       std::uint32_t links) {
  const GeneSpec number{-range, range};
  const auto node = static_cast<std::uint32_t>(layout.types.size());
  const auto count = static_cast<std::uint32_t>(functions.size());
  layout.add_type({"node", {number, {0, 0, count}}, 0, nodes, {"bias", "function"}});
  layout.types[node].name_options(function, std::move(functions));
  const GeneSpec is_on{0, 0, 2}, reference{.refers_to = node};
  layout.add_type({"link", {number, is_on, reference, reference}, 0, links, {"weight", "on", "from", "to"}});
  layout.types[node + 1].name_options(on, {"off", "on"});
  return {node, node + 1};
}

/// Returns the types of the first section that has them, or nothing if there is none.
inline std::optional<Types> types_in(const Layout& layout) {
  for (std::uint32_t node = 0; node + 1 < layout.types.size(); ++node) {
    const BlockType& link = layout.types[node + 1];
    if (layout.types[node].name == "node" && link.name == "link" && link.genes.size() == 4 &&
        link.genes[from].refers_to == node && link.genes[to].refers_to == node)
      return Types{node, node + 1};
  }
  return std::nullopt;
}

}  // namespace evodevo::neat
