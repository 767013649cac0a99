// "Remove a chunk of the least stress springs and introduce as many new springs randomly" (paper, section IV-D2), or
// "based on most stressed springs rather than randomly" (section VII).
#include <numeric>
#include <set>

#include "evodevo/helpers/materials.hpp"
#include "evodevo/helpers/partners.hpp"
#include "evodevo/helpers/stress.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Body;
using evodevo::Chance;
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

/// Suggests pairs of masses for new springs, one after the other. With inherited draws, the suggestion follows from its
/// number and from identities alone.
class Candidates {
 public:
  Candidates(const std::string& where, const DevoContext& context, std::span<const double> stress,
             const Partners& partners, std::size_t count, Chance& chance)
      : context_(context), partners_(partners), chance_(chance) {
    if (where == "most-stressed") most_stressed_ = most_stressed(stress, count, chance);
    if (where == "by-stress") lottery_ = evodevo::StressLottery(stress);
    if (where != "random" || !chance.inherited()) return;
    std::vector<std::uint32_t> masses(context.body.masses.size());
    std::iota(masses.begin(), masses.end(), 0u);
    ring_ = chance.ring_of(masses);
  }

  Candidate next() {
    const std::uint64_t number = turn_++;
    if (!lottery_.empty()) {
      const auto [spring, times] = lottery_.draw(chance_);
      return beside(spring, times);
    }
    if (!most_stressed_.empty())
      return beside(most_stressed_[number % most_stressed_.size()], number / most_stressed_.size());
    if (chance_.inherited()) {
      const std::uint32_t a = ring_.at(context_.draw({"first", number}));
      return {std::minmax({a, ring_.at(context_.draw({"second", number}), a)})};
    }
    const auto masses = static_cast<std::uint32_t>(context_.body.masses.size());
    const std::uint32_t a = chance_.rng().below(masses);
    std::uint32_t b = chance_.rng().below(masses - 1);
    if (b >= a) ++b;
    return {std::minmax({a, b})};
  }

 private:
  /// Suggests a pair that closes a triangle with a spring: one end of the spring and a random partner of its other end.
  /// If that partner is the first end itself, the pair consists of the spring's own two masses. `round` tells several
  /// suggestions for one spring apart.
  Candidate beside(std::uint32_t index, std::uint64_t round) const {
    std::uint32_t from = context_.body.springs[index].a, past = context_.body.springs[index].b;
    if (chance_.inherited() && context_.identity(past) < context_.identity(from)) std::swap(from, past);
    const bool swapped =
        chance_.inherited() ? chance_.number_of(index, {"side", round}) < 0.5 : chance_.rng().chance(0.5);
    if (swapped) std::swap(from, past);
    const std::uint64_t key = evodevo::mixed(evodevo::mixed(round, context_.identity(from)), context_.identity(past));
    const std::uint32_t to = chance_.one_of(partners_.of(past), {"partner", key});
    return {to == from ? std::minmax({from, past}) : std::minmax({from, to}), index};
  }

  const DevoContext& context_;
  const Partners& partners_;
  Chance& chance_;
  std::vector<std::uint32_t> most_stressed_;
  evodevo::StressLottery lottery_;
  evodevo::Ring ring_;
  std::uint64_t turn_ = 0;
};

/// The springs that leave, least stressed first, each of which gives way to one new spring.
class Leaving {
 public:
  Leaving(std::vector<std::uint32_t> springs, Chance& chance)
      : springs_(std::move(springs)), gone_(springs_.size(), false), chance_(chance) {}

  /// Returns the spring that gives way to a new one between two masses: the least stressed. If the new spring takes
  /// over its material and draws are inherited, it is one that follows from the masses instead, so that one new spring
  /// more or less leaves most of the others with the same material.
  std::uint32_t next(bool hands_material_on, const Pair& masses) {
    while (gone_[first_]) ++first_;
    place_ = first_;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = first_; hands_material_on && chance_.inherited() && i < springs_.size(); ++i) {
      if (gone_[i]) continue;
      const double drawn = chance_.number_of(springs_[i], {"leaves", chance_.key_of(masses.first, masses.second)});
      if (drawn < least) place_ = i;
      least = std::min(least, drawn);
    }
    return springs_[place_];
  }
  /// Takes the spring that next() returned off the list.
  void take() { gone_[place_] = true; }

 private:
  std::vector<std::uint32_t> springs_;
  std::vector<bool> gone_;
  std::size_t first_ = 0, place_ = 0;
  Chance& chance_;
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

  evodevo::Traits traits() const override { return {.locality = 60}; }
  evodevo::RecordRequest observes() const override { return measure_.request(); }
  evodevo::Measure measure(evodevo::EditKind) const override { return measure_.measure(); }

  void develop(const DevoContext& context, Edits& edits, Rng& rng) const override {
    const Body& body = context.body;
    const std::size_t count = std::min(body.springs.size(), static_cast<std::size_t>(springs_));
    if (count == 0 || body.masses.size() < 2) return;
    const std::vector<double> stress = measure_.of(context);
    Chance chance(context, rng);
    Leaving leaving(least_stressed(stress, count, chance), chance);
    const Partners partners(body);
    Candidates candidates(where_, context, stress, partners, count, chance);
    std::set<Pair> taken;
    // enough attempts to find free pairs even if only a few are left; the limit ends the search if there are none
    const std::size_t attempts = evodevo::attempts_per_spring * count;
    for (std::size_t attempt = 0; attempt < attempts && taken.size() < count; ++attempt) {
      const auto [pair, beside] = candidates.next();
      const auto [a, b] = pair;
      if (partners.joined(a, b) || taken.contains(pair) || !(norm(context.position(b) - context.position(a)) > 0))
        continue;
      const auto mixed = material_between(body, body.masses[a].material, body.masses[b].material);
      const std::uint32_t leaves = leaving.next(!mixed, pair);
      const evodevo::Spring& gone = body.springs[leaves];
      const Material material = mixed ? *mixed : body.materials[gone.material];
      if (is_air(material)) continue;
      leaving.take();
      taken.insert(pair);
      edits.remove_spring(leaves, {.cause = stress[leaves]});
      evodevo::NewSpring comes{.cause = beside ? stress[*beside] : evodevo::no_cause};
      if (!mixed) comes.stiffness_factor = gone.stiffness_factor, comes.like = leaves;
      edits.join(a, b, material, comes);
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
