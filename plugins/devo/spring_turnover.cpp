// "Remove a chunk of the least stress springs and introduce as many new springs randomly" (paper, section IV-D2), or
// "based on most stressed springs rather than randomly" (section VII).
#include <set>

#include "evodevo/plugin.hpp"
#include "stress.hpp"

namespace {

using evodevo::Body;
using evodevo::DevoContext;
using evodevo::Edits;
using evodevo::Material;
using evodevo::no_material;
using evodevo::Rng;

/// For every mass, the masses that springs join it to (its partners), all in one array.
class Partners {
 public:
  explicit Partners(const Body& body) : first_(body.masses.size() + 1), partners_(2 * body.springs.size()) {
    for (const auto& spring : body.springs) {
      ++first_[spring.a + 1];
      ++first_[spring.b + 1];
    }
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    auto next = first_;
    for (const auto& spring : body.springs) {
      partners_[next[spring.a]++] = spring.b;
      partners_[next[spring.b]++] = spring.a;
    }
  }

  std::span<const std::uint32_t> of(std::uint32_t mass) const {
    return {partners_.data() + first_[mass], first_[mass + 1] - first_[mass]};
  }

  bool joined(std::uint32_t a, std::uint32_t b) const {
    const auto partners = of(a);
    return std::find(partners.begin(), partners.end(), b) != partners.end();
  }

 private:
  std::vector<std::uint32_t> first_;  ///< for each mass, the index of its first partner in `partners_`
  std::vector<std::uint32_t> partners_;
};

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
    if (where == "by-stress") lottery_ = StressLottery(stress);
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
  StressLottery lottery_;
  std::size_t turn_ = 0;
};

/// The number of springs stays the same: a spring is removed only if another can be added. A body in which every pair
/// of masses is joined therefore stays as it is, and a body with fewer springs than `springs` can exchange only those
/// that it has. A new spring joins two masses that are not joined before the application and that are not at the same
/// position; its material is not air. A new spring exerts no force at first.
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

  evodevo::SpringRequest observes() const override { return measure_.request(); }
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
      const Material material = material_between(body, a, b, leaves);
      if (is_air(material)) continue;
      taken.insert(pair);
      edits.removed_springs.push_back(leaves);
      edits.causes.removed_springs.push_back(stress[leaves]);
      edits.new_springs.push_back({a, b, material, {}});
      if (beside) edits.causes.new_springs.push_back(stress[*beside]);
    }
  }

 private:
  /// Returns the mean of the materials of two masses or, if one of them has none, the material of the removed spring.
  static Material material_between(const Body& body, std::uint32_t a, std::uint32_t b, std::uint32_t leaves) {
    const std::int32_t first = body.masses[a].material, second = body.masses[b].material;
    if (first == no_material || second == no_material) return body.materials[body.springs[leaves].material];
    return mean(body.materials[first], body.materials[second]);
  }

  std::int64_t springs_ = 125;
  std::string where_ = "random";
  StressMeasure measure_;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<SpringTurnover>("spring-turnover",
                                                       "Removes the least stressed springs and adds as many elsewhere "
                                                       "(paper, section IV-D2)."))
