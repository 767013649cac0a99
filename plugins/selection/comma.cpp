// The (mu, lambda) selection of evolution strategies (Schwefel 1977).
#include "evodevo/helpers/rows.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Couple;
using evodevo::SelectionContext;
using evodevo::Survival;

/// Of the newborns, the best survive. Those who were alive before fill only the places that are left if too few
/// newborns did not fail. All individuals have the same chance to breed. The experiment should have several times as
/// many `children` as places in the `population`; with equal numbers, nothing is selected.
class Comma final : public evodevo::Selection {
 public:
  evodevo::Traits traits() const override { return {.is_elitist = false}; }

  std::vector<Couple> parents(const SelectionContext& context, std::uint32_t count, evodevo::Rng& rng) const override {
    return draw_pairs(context.rows, count, rng, evodevo::draw_any);
  }

  Survival survivors(const SelectionContext& context, std::uint32_t population, evodevo::Rng&) const override {
    const auto rows = context.rows;
    auto living = best_first(rows);
    const auto failed = std::partition_point(living.begin(), living.end(), [&](auto i) { return rows[i].ok(); });
    const auto newborn = [&](std::uint32_t i) { return rows[i].is_newborn; };
    std::stable_partition(living.begin(), failed, newborn);
    std::stable_partition(failed, living.end(), newborn);
    return evodevo::first_rows(std::move(living), population);
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Comma>("comma",
                                              "The best newborns survive and their parents die, as in a (mu, lambda) "
                                              "evolution strategy (Schwefel 1977)."))
