// Differential evolution, DE/rand/1/bin (Storn and Price 1997).
#include <tuple>

#include "evodevo/helpers/rows.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::GeneSpec;
using evodevo::Genome;
using evodevo::SelectionContext;

/// Each child competes with its parent for the parent's place, and takes it unless its first score is lower. If a
/// parent has several children, only the best of them competes. Those who lose survive only if places are left, or are
/// taken by individuals that failed; of these, those who lose come last.
class Differential final : public evodevo::Selection {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.real(factor_, "factor", {0, 2, "1"},
           "Factor of the difference between two genomes that is added to a third one.");
    p.real(crossover_, "crossover", {0, 1, "1"},
           "Probability that a gene comes from that sum, and not from the parent.");
  }

  evodevo::Traits traits() const override { return {.needs_real_genes = true, .least_population = least}; }

  evodevo::Offspring children(const SelectionContext& context, std::uint32_t count, evodevo::Rng& rng) const override {
    std::vector<evodevo::Child> children;
    const auto order = by_genes(context.rows);
    std::vector<std::uint32_t> turns;  // everyone is a parent once before anyone is again
    while (children.size() < count) {
      if (order.size() < least) {  // in the first generation, and as long as too few are alive
        children.push_back({random_genome(context.layout, rng)});
        continue;
      }
      if (turns.empty()) {
        turns = order;
        rng.shuffle(turns);
      }
      children.push_back({varied(context, order, turns.back(), rng), {turns.back()}});
      turns.pop_back();
    }
    return children;
  }

  evodevo::Survival survivors(const SelectionContext& context, std::uint32_t population, evodevo::Rng&) const override {
    const auto rows = context.rows;
    const auto order = best_first(rows);
    const auto lost = lost_challenges(
        rows, order, [&](auto child, auto parent) { return !evodevo::is_better(rows[parent], rows[child]); });
    std::vector<std::uint32_t> groups[4];  // winners, losers, and then both of those who failed
    for (const std::uint32_t row : order) groups[(rows[row].ok() ? 0 : 2) + (lost[row] ? 1 : 0)].push_back(row);
    std::vector<std::uint32_t> living;
    for (const auto& group : groups) living.insert(living.end(), group.begin(), group.end());
    return evodevo::first_rows(std::move(living), population);
  }

 private:
  static constexpr std::uint32_t least = 4;  ///< the parent, and three others for the sum

  /// Returns the rows in the order of their genes, ties by id: individuals that failed breed too, and scores do not
  /// tell them apart.
  static std::vector<std::uint32_t> by_genes(std::span<const evodevo::Candidate> rows) {
    std::vector<std::uint32_t> order(rows.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::sort(order, {}, [&](auto row) { return std::tie(rows[row].genome->genes, rows[row].id); });
    return order;
  }

  Genome varied(const SelectionContext& context, const std::vector<std::uint32_t>& order, std::uint32_t parent,
                evodevo::Rng& rng) const {
    auto others = order;
    std::erase(others, parent);
    const Genome* chosen[3];
    for (const Genome*& one : chosen) {
      const auto at = others.begin() + rng.below(static_cast<std::uint32_t>(others.size()));
      one = context.rows[*at].genome;
      others.erase(at);
    }
    Genome child = *context.rows[parent].genome;
    if (child.empty()) return child;
    const std::uint32_t certain = rng.below(static_cast<std::uint32_t>(child.size()));  // at least one gene changes
    for (const evodevo::Block& block : context.layout.first_blocks)
      for (std::uint32_t i = block.first; i < block.first + block.count; ++i) {
        if (!rng.chance(crossover_) && i != certain) continue;
        const double sum = (*chosen[0])[i] + factor_ * (double{(*chosen[1])[i]} - (*chosen[2])[i]);
        child[i] = within(context.layout.types[block.type].gene(i - block.first), sum, (*chosen[0])[i], rng);
      }
    return child;
  }

  /// Returns a value within the bounds of a gene. One that is not is replaced by a random one between the bound and the
  /// value from which it started (Price et al. 2005).
  static float within(const GeneSpec& spec, double value, double start, evodevo::Rng& rng) {
    if (value < spec.low) value = rng.uniform(spec.low, start);
    if (value > spec.high) value = rng.uniform(start, spec.high);
    return std::clamp(static_cast<float>(value), spec.low, spec.high);
  }

  double factor_ = 0.5;
  double crossover_ = 0.9;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Differential>("differential",
                                                     "Children differ from their parents by the differences between "
                                                     "others, and take their places if they are not worse (Storn & "
                                                     "Price 1997)."))
