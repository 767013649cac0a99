// NSGA-II: non-dominated sorting and crowding (Deb et al. 2002).
#include "evodevo/helpers/rows.hpp"
#include "evodevo/helpers/selection/pareto.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Couple;
using evodevo::SelectionContext;
using evodevo::Survival;

/// The best Pareto layers survive. Of the first layer that does not fit into the population as a whole, the least
/// crowded members survive; crowding is measured anew after each removal, which spreads them more evenly (Kukkonen and
/// Deb 2006). Parents are the winners of tournaments between two: the better layer wins, then the less crowded one, and
/// among equals chance decides. Individuals that failed lose to all others; among them, those win that violate the
/// constraints least.
class Nsga2 final : public evodevo::Selection {
 public:
  std::vector<Couple> parents(const SelectionContext& context, std::uint32_t count, evodevo::Rng& rng) const override {
    const auto rows = context.rows;
    auto pool = breeding_rows(rows);
    rng.shuffle(pool);  // a random order among equals
    std::ranges::stable_sort(pool, {}, [&](std::uint32_t row) { return rows[row].violation; });  // if all have failed
    return draw_pairs(by_layer_and_room(evodevo::points_of(rows), std::move(pool)), count, rng, evodevo::Tournament{2});
  }

  Survival survivors(const SelectionContext& context, std::uint32_t population, evodevo::Rng&) const override {
    return evodevo::best_layers(evodevo::points_of(context.rows), best_first(context.rows), population);
  }

 private:
  /// Returns the rows of a pool from best to worst, by the crowded comparison of NSGA-II. Equals stay in their order.
  static std::vector<std::uint32_t> by_layer_and_room(const std::vector<evodevo::Point>& points,
                                                      std::vector<std::uint32_t> pool) {
    const auto layer = evodevo::pareto_layers(points);
    std::vector<double> room(points.size());
    std::vector<std::vector<std::uint32_t>> layers;
    for (const std::uint32_t row : pool) {
      layers.resize(std::max<std::size_t>(layers.size(), layer[row] + 1));
      layers[layer[row]].push_back(row);
    }
    for (const auto& members : layers) {
      const evodevo::Crowd crowd(points, members);
      for (std::uint32_t i = 0; i < members.size(); ++i) room[members[i]] = crowd.room(i);
    }
    std::stable_sort(pool.begin(), pool.end(),
                     [&](auto a, auto b) { return layer[a] != layer[b] ? layer[a] < layer[b] : room[a] > room[b]; });
    return pool;
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Nsga2>("nsga2",
                                              "The best Pareto layers and the least crowded individuals survive and "
                                              "win tournaments (NSGA-II: Deb et al. 2002)."))
