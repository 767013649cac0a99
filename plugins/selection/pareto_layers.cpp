// "A solution is considered better if it belongs to a higher layer, or if belongs to the same layer with higher
// fitness. [...] During replacement, all solutions on the Pareto Front are exempt" (paper, section IV-F).
#include "evodevo/helpers/rows.hpp"
#include "evodevo/helpers/selection/pareto.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Couple;
using evodevo::SelectionContext;
using evodevo::Survival;

/// The paper's replacement. The paper leaves some choices open. Here, a child competes with its parent for the parent's
/// place; if a parent has several children, only the best of them can win. Individuals without a parent compete for the
/// places of the worst individuals. "Fitness" is the first objective. The whole front survives; if it is larger than
/// the population, its most crowded members do not survive. Individuals that lost against their parent or child survive
/// only if places are left, and failed individuals only after all others.
class ParetoLayers final : public evodevo::Selection {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.flag(age_, "age", "Whether a low age is an objective in addition to those of the fitness operators.");
  }

  std::vector<Couple> parents(const SelectionContext& context, std::uint32_t count, evodevo::Rng& rng) const override {
    return draw_pairs(context.rows, count, rng, evodevo::draw_any);
  }

  Survival survivors(const SelectionContext& context, std::uint32_t population, evodevo::Rng&) const override {
    const auto rows = context.rows;
    auto order = best_first(rows);
    const auto points = age_ ? evodevo::scores_and_youth(rows) : evodevo::points_of(rows);
    const auto layer = evodevo::pareto_layers(points);
    // from best to worst: by layer, and within a layer by fitness, by which the rows are sorted already
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return layer[a] < layer[b]; });
    const auto lost = lost_challenges(rows, order, [&](auto child, auto parent) {
      if (layer[child] != layer[parent]) return layer[child] < layer[parent];
      return rows[child].ok() && rows[child].scores[0] > rows[parent].scores[0];
    });

    std::vector<std::uint32_t> front, winners, losers, failed;
    for (const std::uint32_t row : order)
      (layer[row] == 0 ? front : !rows[row].ok() ? failed : lost[row] ? losers : winners).push_back(row);
    std::vector<std::uint32_t> living = evodevo::least_crowded(points, front, population);
    for (const auto* group : {&winners, &losers, &failed}) living.insert(living.end(), group->begin(), group->end());
    return evodevo::first_rows(std::move(living), population);
  }

 private:
  bool age_ = true;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<ParetoLayers>("pareto-layers",
                                                     "A child replaces its parent if it lies in a better Pareto "
                                                     "layer, or in the same layer with higher fitness (paper, section "
                                                     "IV-F)."))
