// "Remove masses that fall below a threshold and add a new mass with the base amount of springs" (paper, section
// IV-D3).
#include "arrivals.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Body;
using evodevo::Edits;
using evodevo::Moment;
using evodevo::Rng;

/// The paper's operation, "currently partially implemented" there, with the choices that it leaves open. Masses are
/// judged once, before any goes; springs of air count, since a body with much air would be wiped out otherwise; at
/// most `limit` and half of the body go at once, fewest springs first. A mass for which no free place is found stays.
class MassTurnover final : public evodevo::Devo {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.integer(threshold_, "threshold", {0, 100'000, "1"}, "Masses with fewer springs than these go.");
    p.integer(limit_, "limit", {0, 100'000, "1"}, "Masses that go in one cycle at most.");
    arrival_.declare(p);
  }

  evodevo::SpringRequest observes() const override { return arrival_.request(); }
  evodevo::Measure measure(evodevo::Causes::List list) const override {
    if (list == &evodevo::Causes::removed_masses) return {"valence", "springs"};
    return arrival_.measure.measure();
  }

  void develop(const Moment& now, Edits& edits, Rng& rng) const override {
    const std::vector<std::int64_t> valence = valences(now.body);
    const auto leaving = poorest(valence, rng);
    if (leaving.empty() || now.body.springs.empty()) return;

    Arrivals arrivals(arrival_, now);
    std::vector<std::uint32_t> removed;
    for (const std::uint32_t mass : leaving) {
      arrivals.set_staying(mass, false);
      if (arrivals.find_place(rng))
        removed.push_back(mass);
      else
        arrivals.set_staying(mass, true);
    }
    if (!arrivals.come(edits, rng)) return;
    edits.removed_masses = removed;
    for (const std::uint32_t mass : removed) edits.causes.removed_masses.push_back(static_cast<double>(valence[mass]));
  }

 private:
  /// How many springs each mass has, those of air included.
  static std::vector<std::int64_t> valences(const Body& body) {
    std::vector<std::int64_t> valence;
    for (const auto& mass : body.masses) valence.push_back(mass.air_contacts);
    for (const auto& spring : body.springs) {
      ++valence[spring.a];
      ++valence[spring.b];
    }
    return valence;
  }

  /// The masses below the threshold that may go, fewest springs first, ties in random order.
  std::vector<std::uint32_t> poorest(const std::vector<std::int64_t>& valence, Rng& rng) const {
    std::vector<std::uint32_t> poor;
    for (std::uint32_t i = 0; i < valence.size(); ++i)
      if (valence[i] < threshold_) poor.push_back(i);
    rng.shuffle(poor);
    std::stable_sort(poor.begin(), poor.end(), [&](auto a, auto b) { return valence[a] < valence[b]; });
    poor.resize(std::min({poor.size(), static_cast<std::size_t>(limit_), valence.size() / 2}));
    return poor;
  }

  std::int64_t threshold_ = 20;
  std::int64_t limit_ = 10;
  ArrivalRule arrival_;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<MassTurnover>("mass-turnover",
                                                     "Masses with few springs go, and as many come elsewhere "
                                                     "(paper, section IV-D3)."))
