// "A solution is considered better if it belongs to a higher layer, or if belongs to the same layer with higher
// fitness. [...] During replacement, all solutions on the Pareto Front are exempt" (paper, section IV-F).
#include "evodevo/helpers/pareto.hpp"
#include "evodevo/helpers/rows.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Candidate;

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

  std::vector<std::pair<std::uint32_t, std::uint32_t>> parents(std::span<const Candidate> rows, std::uint32_t count,
                                                               evodevo::Rng& rng) const override {
    return draw_pairs(rows, count, rng, evodevo::draw_any);
  }

  std::vector<std::uint32_t> survivors(std::span<const Candidate> rows, std::uint32_t population,
                                       evodevo::Rng&) const override {
    const auto order = best_first(rows);
    const auto sorted = in_order(rows, order);
    const auto points = age_ ? evodevo::scores_and_youth(sorted) : evodevo::points_of(sorted);
    const auto layer = evodevo::pareto_layers(points);

    // from best to worst: by layer, and within a layer by fitness, by which the rows are sorted already
    std::vector<std::uint32_t> ranked(rows.size());
    std::iota(ranked.begin(), ranked.end(), 0u);
    std::stable_sort(ranked.begin(), ranked.end(), [&](auto a, auto b) { return layer[a] < layer[b]; });
    const auto lost = losers(sorted, parent_positions(rows, order), layer, ranked);

    std::vector<std::uint32_t> front, winners, others, failed;
    for (const std::uint32_t i : ranked)
      (layer[i] == 0 ? front : !sorted[i].ok() ? failed : lost[i] ? others : winners).push_back(i);
    std::vector<std::uint32_t> living = evodevo::least_crowded(points, front, population);
    for (const auto* group : {&winners, &others, &failed}) living.insert(living.end(), group->begin(), group->end());
    living.resize(std::min<std::size_t>(living.size(), population));
    for (std::uint32_t& i : living) i = order[i];
    return living;
  }

 private:
  /// Returns, for every row of the sorted table, the position of its parent in that table, or rows.size() for no
  /// parent.
  static std::vector<std::size_t> parent_positions(std::span<const Candidate> rows,
                                                   const std::vector<std::uint32_t>& order) {
    std::vector<std::size_t> location_of(rows.size()), parents;
    for (std::size_t i = 0; i < order.size(); ++i) location_of[order[i]] = i;
    for (const std::uint32_t row : order)
      parents.push_back(rows[row].challenges ? location_of[*rows[row].challenges] : rows.size());
    return parents;
  }

  /// Returns which rows lost: a parent if its best child is better, and a child if it is not better than its parent, or
  /// if it is not the best of its parent's children.
  static std::vector<bool> losers(const std::vector<Candidate>& rows, const std::vector<std::size_t>& parents,
                                  const std::vector<std::uint32_t>& layer, const std::vector<std::uint32_t>& ranked) {
    const auto better = [&](std::size_t a, std::size_t b) {
      if (layer[a] != layer[b]) return layer[a] < layer[b];
      return rows[a].ok() && rows[a].scores[0] > rows[b].scores[0];
    };
    std::vector<bool> lost(rows.size(), false), replaced(rows.size(), false);
    for (const std::uint32_t child : ranked) {
      const std::size_t parent = parents[child];
      if (parent == rows.size()) continue;
      const bool wins = !replaced[parent] && better(child, parent);
      (wins ? replaced[parent] : lost[child]) = true;
      if (wins) lost[parent] = true;
    }
    return lost;
  }

  bool age_ = true;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<ParetoLayers>("pareto-layers",
                                                     "A child replaces its parent if it lies in a better Pareto "
                                                     "layer, or in the same layer with higher fitness (paper, section "
                                                     "IV-F)."))
