// Lexicase selection of parents by the tests that they passed (Spector 2012; La Cava et al. 2016).
#include "evodevo/helpers/selection/lexicase.hpp"

#include "evodevo/helpers/rows.hpp"
#include "evodevo/plugin.hpp"

namespace {

/// Each parent is drawn by filtering the individuals through all test cases in a new random order. A case is an
/// objective in one repeat of one scenario. Scores that differ by no more than a tolerance count as equal.
class Lexicase final : public evodevo::Selection {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.optional_real(tolerance_, "tolerance", {0, 1e9, "unit of the score"},
                    "Difference between scores that does not count; without it, the median absolute deviation of the "
                    "scores in each case.");
  }

  std::vector<evodevo::Couple> parents(const evodevo::SelectionContext& context, std::uint32_t count,
                                       evodevo::Rng& rng) const override {
    const auto pool = breeding_rows(context.rows);
    std::vector<evodevo::CaseScores> scores;
    for (const std::uint32_t row : pool) scores.push_back(context.rows[row].cases);
    auto tolerance = evodevo::median_deviations(scores);
    if (tolerance_) std::fill(tolerance.begin(), tolerance.end(), *tolerance_);

    std::vector<evodevo::Couple> couples;
    for (std::uint32_t i = 0; i < count && !pool.empty(); ++i) {
      const std::uint32_t parent = evodevo::draw_lexicase(scores, tolerance, rng);
      std::uint32_t mate = parent;
      if (pool.size() > 1) {
        auto others = scores;
        others.erase(others.begin() + parent);
        mate = evodevo::draw_lexicase(others, tolerance, rng);
        if (mate >= parent) ++mate;  // an index into `others` leaves out the parent
      }
      couples.push_back({pool[parent], pool[mate]});
    }
    return couples;
  }

 private:
  std::optional<double> tolerance_;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Lexicase>("lexicase",
                                                 "Each parent is the best in some scenarios and objectives, taken in a "
                                                 "random order (La Cava et al. 2016)."))
