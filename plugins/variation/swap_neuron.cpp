// "Taking a random neuron in the neural network encoding and swapping the connected weights" (paper, section IV-B).
#include "evodevo/plugin.hpp"

namespace {

/// The child is the first parent with one block of the second, and so the crossover works with any encoding. In a
/// neural network, a block consists of the bias and the input weights of one neuron.
class SwapNeuron final : public evodevo::Crossover {
 public:
  evodevo::Genome cross(const evodevo::Parents& parents, const evodevo::VariationContext& context,
                        evodevo::Rng& rng) const override {
    evodevo::Genome child = parents.first;
    const auto partners = homologous(child, parents.second, context.layout);
    if (partners.empty()) return child;
    const std::uint32_t block = rng.below(static_cast<std::uint32_t>(partners.size()));
    if (partners[block]) copy_genes(child, block, parents.second, *partners[block], context.layout);
    return child;
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<SwapNeuron>("swap-neuron",
                                                   "Takes one random block of genes, such as a neuron's bias and "
                                                   "weights, from the second parent (paper, section IV-B)."))
