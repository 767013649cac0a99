// "Remove masses that fall below a threshold and add a new mass with the base amount of springs" (paper, section
// IV-D3).
#include "evodevo/helpers/arrivals.hpp"
#include "evodevo/helpers/partners.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::DevoContext;
using evodevo::Edits;
using evodevo::Rng;

/// The paper's operation, which the paper calls "currently partially implemented". The paper leaves some choices open.
/// Here, the operator determines the degree of all masses once, before it removes any. Contacts to air count as
/// springs, because a body with much air would be wiped out otherwise. One application removes the masses with the
/// fewest springs, at most `limit` masses and at most half of the body's masses. The operator removes a mass only if it
/// finds a free position for a new one.
class MassTurnover final : public evodevo::Devo {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.integer(threshold_, "threshold", {0, 100'000, "1"}, "Masses with fewer springs than this number are removed.");
    p.integer(limit_, "limit", {0, 100'000, "1"}, "Largest number of masses that are removed in one cycle.");
    arrival_.declare(p);
  }

  evodevo::Traits traits() const override { return {.locality = 60}; }
  evodevo::RecordRequest observes() const override { return arrival_.request(); }
  evodevo::Measure measure(evodevo::EditKind edit) const override {
    if (edit == evodevo::EditKind::removed_mass) return {"degree", "springs"};
    return arrival_.measure.measure();
  }

  void develop(const DevoContext& context, Edits& edits, Rng& rng) const override {
    const std::vector<std::int64_t> degree = evodevo::degrees(context.body);
    evodevo::Chance chance(context, rng);
    const auto leaving = poorest(degree, context, chance);
    if (leaving.empty() || context.body.springs.empty()) return;

    evodevo::Arrivals arrivals(arrival_, context, chance);
    std::vector<std::uint32_t> removed;
    for (const std::uint32_t mass : leaving) {
      arrivals.set_staying(mass, false);
      if (arrivals.find_position())
        removed.push_back(mass);
      else
        arrivals.set_staying(mass, true);
    }
    if (!arrivals.come(edits)) return;
    for (const std::uint32_t mass : removed) edits.remove_mass(mass, {.cause = static_cast<double>(degree[mass])});
  }

 private:
  /// Returns the masses below the threshold that may be removed, fewest springs first, ties in random order.
  std::vector<std::uint32_t> poorest(const std::vector<std::int64_t>& degree, const DevoContext& context,
                                     evodevo::Chance& chance) const {
    std::vector<std::uint32_t> poor;
    for (std::uint32_t i = 0; i < degree.size(); ++i)
      if (degree[i] < threshold_) poor.push_back(i);
    if (!chance.inherited()) chance.rng().shuffle(poor);
    const auto key = [&](std::uint32_t mass) {
      return std::pair(degree[mass], chance.inherited() ? context.draw(mass, "tie") : 0);
    };
    std::ranges::stable_sort(poor, {}, key);
    poor.resize(std::min({poor.size(), static_cast<std::size_t>(limit_), degree.size() / 2}));
    return poor;
  }

  std::int64_t threshold_ = 20;
  std::int64_t limit_ = 10;
  evodevo::ArrivalRule arrival_;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<MassTurnover>("mass-turnover",
                                                     "Removes masses with few springs and adds as many elsewhere "
                                                     "(paper, section IV-D3)."))
