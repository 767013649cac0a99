// Age-fitness Pareto optimisation (Schmidt & Lipson 2011; paper, section IV-F).
#include "evodevo/helpers/rows.hpp"
#include "evodevo/helpers/pareto.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Candidate;

/// Youth is an additional objective, so that old champions do not displace new individuals at once. Whole Pareto layers
/// survive, the front first. Of the first layer that does not fit into the population as a whole, the least crowded
/// members survive (Deb et al. 2002).
class AgeFitnessPareto final : public evodevo::Selection {
 public:
  std::vector<std::pair<std::uint32_t, std::uint32_t>> parents(std::span<const Candidate> rows, std::uint32_t count,
                                                               evodevo::Rng& rng) const override {
    return draw_pairs(rows, count, rng, evodevo::draw_any);
  }

  std::vector<std::uint32_t> survivors(std::span<const Candidate> rows, std::uint32_t population,
                                       evodevo::Rng&) const override {
    const auto order = best_first(rows);
    const auto points = evodevo::scores_and_youth(in_order(rows, order));
    const auto layer = evodevo::pareto_layers(points);
    std::vector<std::uint32_t> living;
    for (std::uint32_t depth = 0; living.size() < population; ++depth) {
      std::vector<std::uint32_t> members;
      for (std::uint32_t i = 0; i < layer.size(); ++i)
        if (layer[i] == depth) members.push_back(i);
      if (members.empty()) break;
      for (const std::uint32_t i : evodevo::least_crowded(points, members, population - living.size()))
        living.push_back(order[i]);
    }
    return living;
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<AgeFitnessPareto>("age-fitness-pareto",
                                                         "The best Pareto layers by the objectives and by low age "
                                                         "survive (Schmidt & Lipson 2011; paper, section IV-F)."))
