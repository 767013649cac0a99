// Two-point crossover, which the paper plans as future work for its neural networks (section VII).
#include "evodevo/plugin.hpp"

namespace {

/// Cuts both genomes at the same two positions, and swaps the genes between the two cuts. A cut may also lie before the
/// first gene or after the last one.
class TwoPoint final : public evodevo::Crossover {
 public:
  void cross(evodevo::Genome& one, evodevo::Genome& other, const evodevo::Layout&, evodevo::Rng& rng) const override {
    if (one.empty()) return;
    const auto genes = static_cast<std::uint32_t>(one.size());
    std::uint32_t begin = rng.below(genes + 1), end = rng.below(genes);
    if (end >= begin) ++end;  // so that `end` is any of the positions except `begin`
    if (begin > end) std::swap(begin, end);
    std::swap_ranges(one.begin() + begin, one.begin() + end, other.begin() + begin);
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<TwoPoint>("two-point",
                                                 "Swaps the genes between two random cuts (De Jong 1975; paper, "
                                                 "section VII)."))
