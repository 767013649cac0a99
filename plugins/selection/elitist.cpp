// Simple elitist selection: the best individuals survive, and parents are the winners of small tournaments.
#include "evodevo/helpers/rows.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Couple;
using evodevo::SelectionContext;
using evodevo::Survival;

/// The best individual is the one with the highest first score. Ties are broken by the other scores, then by youth.
class Elitist final : public evodevo::Selection {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.integer(tournament_, "tournament", {1, 1000, "1"},
              "Number of individuals drawn for each parent, of which the best breeds.");
  }

  std::vector<Couple> parents(const SelectionContext& context, std::uint32_t count, evodevo::Rng& rng) const override {
    return draw_pairs(context.rows, count, rng, evodevo::Tournament{tournament_});
  }

  Survival survivors(const SelectionContext& context, std::uint32_t population, evodevo::Rng&) const override {
    return evodevo::first_rows(best_first(context.rows), population);
  }

 private:
  std::int64_t tournament_ = 2;
};

}  // namespace

EVODEVO_PLUGIN(
    EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
    evodevo::operator_entry<Elitist>("elitist",
                                     "The best individuals survive, and winners of tournaments breed (Goldberg "
                                     "& Deb 1991)."))
