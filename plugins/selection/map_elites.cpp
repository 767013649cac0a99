// MAP-Elites (Mouret and Clune 2015; with centroidal cells: Vassiliades et al. 2018).
#include <optional>
#include <set>

#include "evodevo/helpers/rows.hpp"
#include "evodevo/helpers/selection/niches.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Coordinates;
using evodevo::SelectionContext;

/// The space of the descriptors is divided into cells, and the best individual of each cell survives: the population is
/// the map. Individuals are compared by their first score; ties are broken by the other scores, then by youth. All
/// elites have the same chance to breed. If the population has fewer places than there are elites, the worst of them
/// die. The memory holds the centres of the cells.
class MapElites final : public evodevo::Selection {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.choice(cells_, "cells", {"grid", "centroidal"},
             "Shape of the cells: the grid of the descriptors' bins, or cells of similar size for many descriptors.");
    p.integer(count_, "count", {1, 10'000, "1"}, "Number of centroidal cells.");
  }

  evodevo::Traits traits() const override { return {.least_descriptors = 1}; }
  std::vector<evodevo::NoteTitle> notes() const override { return {{.name = "cell", .is_label = true}}; }
  std::vector<std::string> memory() const override {
    return cells_ == "grid" ? std::vector<std::string>() : std::vector<std::string>{"centres"};
  }
  /// Draws the same cells in all runs, so that their maps can be compared.
  void prepare(const evodevo::EncodingContext& context) override { rng_ = context.rng(1); }

  std::vector<evodevo::Couple> parents(const SelectionContext& context, std::uint32_t count,
                                       evodevo::Rng& rng) const override {
    return draw_pairs(context.rows, count, rng, evodevo::draw_any);
  }

  evodevo::Survival survivors(const SelectionContext& context, std::uint32_t population, evodevo::Rng&) const override {
    const bool is_grid = cells_ == "grid";
    const evodevo::Neighbours centres(is_grid ? std::vector<Coordinates>() : centres_in(context));
    const auto order = breeding_rows(context.rows);
    std::set<std::uint64_t> filled;
    evodevo::Survival survival;
    for (const std::uint32_t row : order) {
      const evodevo::Candidate& candidate = context.rows[row];
      if (!candidate.ok()) {  // all failed
        survival.rows.push_back(row);
        continue;
      }
      const std::uint64_t cell = is_grid ? evodevo::grid_cell(candidate.descriptors, context.descriptors)
                                         : centres.nearest(place_of(candidate, context.descriptors), 1).front().index;
      survival.notes.push_back({row, 0, static_cast<double>(cell)});
      if (filled.insert(cell).second) survival.rows.push_back(row);
    }
    survival.rows = evodevo::first_rows(std::move(survival.rows), population);
    if (!is_grid && context.memory.empty())
      survival.memory = evodevo::SelectionMemory{.lists = {{"centres", evodevo::list_of_places(centres.places())}}};
    return survival;
  }

 private:
  std::vector<Coordinates> centres_in(const SelectionContext& context) const {
    const std::size_t dimension = context.descriptors.size();
    if (context.memory.empty()) {
      evodevo::Rng rng = *rng_;
      return evodevo::voronoi_centres(static_cast<std::uint32_t>(count_), dimension, rng);
    }
    return evodevo::places_in(context.memory, "centres", static_cast<std::size_t>(count_), dimension);
  }

  std::string cells_ = "grid";
  std::int64_t count_ = 1000;
  std::optional<evodevo::Rng> rng_;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<MapElites>("map-elites",
                                                  "The best individual of each cell of the space of descriptors "
                                                  "survives (Mouret & Clune 2015; Vassiliades et al. 2018)."))
