// Age-fitness Pareto optimisation (Schmidt & Lipson 2011; paper, section IV-F).
#include "evodevo/helpers/rows.hpp"
#include "evodevo/helpers/selection/pareto.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Couple;
using evodevo::SelectionContext;
using evodevo::Survival;

/// Youth is an additional objective, so that old champions do not displace new individuals at once. Whole Pareto layers
/// survive, the front first. Of the first layer that does not fit into the population as a whole, the least crowded
/// members survive (Deb et al. 2002).
class AgeFitnessPareto final : public evodevo::Selection {
 public:
  std::vector<Couple> parents(const SelectionContext& context, std::uint32_t count, evodevo::Rng& rng) const override {
    return draw_pairs(context.rows, count, rng, evodevo::draw_any);
  }

  Survival survivors(const SelectionContext& context, std::uint32_t population, evodevo::Rng&) const override {
    return evodevo::best_layers(evodevo::scores_and_youth(context.rows), best_first(context.rows), population);
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<AgeFitnessPareto>("age-fitness-pareto",
                                                         "The best Pareto layers by the objectives and by low age "
                                                         "survive (Schmidt & Lipson 2011; paper, section IV-F)."))
