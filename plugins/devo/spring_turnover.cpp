// "Remove a chunk of the least stress springs and introduce as many new springs randomly" (paper, section IV-D2), or
// "based on most stressed springs rather than randomly" (section VII).
#include <set>

#include "evodevo/helpers/materials.hpp"
#include "evodevo/helpers/partners.hpp"
#include "evodevo/helpers/stress.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Body;
using evodevo::DevoContext;
using evodevo::Edits;
using evodevo::Material;
using evodevo::Partners;
using evodevo::Rng;

using Pair = std::pair<std::uint32_t, std::uint32_t>;

/// Two masses that a new spring may join.
struct Candidate {
  Pair pair;
  std::optional<std::uint32_t> beside = {};  ///< the stressed spring beside which the new spring would lie, if any
};

/// Suggests pairs of masses for new springs.
class Candidates {
 public:
  Candidates(const std::string& where, const DevoContext& context, std::span<const double> stress,
             const Partners& partners, std::size_t count, Rng& rng)
      : context_(context), partners_(partners) {
    if (where == "most-stressed") most_stressed_ = most_stressed(stress, count, rng);
    if (where == "by-stress") lottery_ = evodevo::StressLottery(stress);
  }

  Candidate next(Rng& rng) {
    if (!lottery_.empty()) return beside(lottery_.draw(rng), rng);
    if (!most_stressed_.empty()) return beside(most_stressed_[turn_++ % most_stressed_.size()], rng);
    const auto masses = static_cast<std::uint32_t>(context_.body.masses.size());
    const std::uint32_t a = rng.below(masses);
    std::uint32_t b = rng.below(masses - 1);
    if (b >= a) ++b;
    return {std::minmax(a, b)};
  }

 private:
  /// Suggests a pair that closes a triangle with a spring: one end of the spring and a random partner of its other end.
  /// If that partner is the first end itself, the pair consists of the spring's own two masses.
  Candidate beside(std::uint32_t index, Rng& rng) const {
    std::uint32_t from = context_.body.springs[index].a, past = context_.body.springs[index].b;
    if (rng.chance(0.5)) std::swap(from, past);
    const auto partners = partners_.of(past);
    const std::uint32_t to = partners[rng.below(static_cast<std::uint32_t>(partners.size()))];
    return {to == from ? std::minmax(from, past) : std::minmax(from, to), index};
  }

  const DevoContext& context_;
  const Partners& partners_;
  std::vector<std::uint32_t> most_stressed_;
  evodevo::StressLottery lottery_;
  std::size_t turn_ = 0;
};

/// The number of springs stays the same: a spring is removed only if another can be added. A body in which every pair
/// of masses is joined therefore stays as it is, and a body with fewer springs than `springs` can exchange only those
/// that it has. A new spring joins two masses that are not joined before the application and that are not at the same
/// position; its material is the mean of theirs or, if one has none, that of the removed spring, and is not air. A new
/// spring exerts no force at first.
class SpringTurnover final : public evodevo::Devo {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.integer(springs_, "springs", {1, 1'000'000, "1"},
              "Number of least stressed springs that are removed, and of springs that are added.");
    p.choice(
        where_, "where", {"random", "most-stressed", "by-stress"},
        "Where springs are added: between random masses, beside each of as many most stressed springs, or beside "
        "springs drawn with probability by stress. A spring that is added beside another closes a triangle with it.");
    measure_.declare(p);
  }

  evodevo::RecordRequest observes() const override { return measure_.request(); }
  evodevo::Measure measure(evodevo::Causes::List) const override { return measure_.measure(); }

  void develop(const DevoContext& context, Edits& edits, Rng& rng) const override {
    const Body& body = context.body;
    const std::size_t count = std::min(body.springs.size(), static_cast<std::size_t>(springs_));
    if (count == 0 || body.masses.size() < 2) return;
    const std::vector<double> stress = measure_.of(context);
    const auto leaving = least_stressed(stress, count, rng);
    const Partners partners(body);
    Candidates candidates(where_, context, stress, partners, count, rng);
    std::set<Pair> taken;
    // enough attempts to find free pairs even if only a few are left; the limit ends the search if there are none
    for (std::size_t attempts = evodevo::attempts_per_spring * count; attempts > 0 && taken.size() < count;
         --attempts) {
      const auto [pair, beside] = candidates.next(rng);
      const auto [a, b] = pair;
      if (partners.joined(a, b) || taken.contains(pair) || !(norm(context.position(b) - context.position(a)) > 0))
        continue;
      const std::uint32_t leaves = leaving[taken.size()];
      const auto mixed = material_between(body, body.masses[a].material, body.masses[b].material);
      const evodevo::Spring& gone = body.springs[leaves];
      const Material material = mixed ? *mixed : body.materials[gone.material];
      if (is_air(material)) continue;
      taken.insert(pair);
      edits.removed_springs.push_back(leaves);
      edits.causes.removed_springs.push_back(stress[leaves]);
      edits.new_springs.push_back(
          {a, b, material, {}, mixed ? 1 : gone.stiffness_factor, mixed ? 0 : gone.phase_growth});
      if (beside) edits.causes.new_springs.push_back(stress[*beside]);
    }
  }

 private:
  std::int64_t springs_ = 125;
  std::string where_ = "random";
  evodevo::StressMeasure measure_;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<SpringTurnover>("spring-turnover",
                                                       "Removes the least stressed springs and adds as many elsewhere "
                                                       "(paper, section IV-D2)."))
