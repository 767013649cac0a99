// "Taking a random neuron in the neural network encoding and swapping the connected weights" (paper, section IV-B).
#include "evodevo/plugin.hpp"

namespace {

/// Swaps one of the layout's gene groups, and so works with any encoding. In a neural network, a gene group consists of
/// the bias and the input weights of one neuron.
class SwapNeuron final : public evodevo::Crossover {
 public:
  void cross(evodevo::Genome& one, evodevo::Genome& other, const evodevo::Layout& layout,
             evodevo::Rng& rng) const override {
    if (layout.groups.empty()) return;
    const evodevo::GeneGroup group = layout.groups[rng.below(static_cast<std::uint32_t>(layout.groups.size()))];
    std::swap_ranges(one.begin() + group.first, one.begin() + group.first + group.count, other.begin() + group.first);
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<SwapNeuron>("swap-neuron",
                                                   "Swaps one random group of genes, such as the bias and weights "
                                                   "of a neuron (paper, section IV-B)."))
