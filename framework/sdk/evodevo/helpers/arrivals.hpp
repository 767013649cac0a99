// For devo operators that add masses: where a new mass is placed, and which masses it is joined to.
#pragma once

#include "evodevo/devo.hpp"
#include "evodevo/helpers/materials.hpp"
#include "evodevo/helpers/partners.hpp"
#include "evodevo/helpers/stress.hpp"

namespace evodevo {

/// The parameters that determine how new masses are placed and joined: as in the paper (section IV-D3), or as the paper
/// proposes for future work (section VII).
struct ArrivalRule {
  std::int64_t springs = 25;
  double min_distance = 0.02;  ///< m
  std::string where = "random";
  std::string join = "random";
  StressMeasure measure;

  void declare(Parameters& p) {
    p.integer(springs, "springs", {1, 100'000, "1"}, "Number of springs that join a new mass to masses that stay.");
    p.real(min_distance, "min_distance", {0, 100, "m"}, "Smallest distance of a new mass from all other masses.");
    p.choice(where, "where", {"random", "by-stress"},
             "Where a new mass is placed: anywhere in the body's bounding box, or on a spring drawn with probability "
             "by stress.");
    p.choice(join, "join", {"random", "nearest"},
             "Which masses a new mass is joined to: random ones or the nearest ones.");
    measure.declare(p);
  }

  RecordRequest request() const { return where == "by-stress" ? measure.request() : RecordRequest{}; }
};

/// Adds new masses to a body that has at least one spring. A new mass gets the material of a random mass that stays in
/// the body and is not air. A new spring gets the mean material of its two masses or, if one of them has no material,
/// the material of a random spring of the body.
class Arrivals {
 public:
  Arrivals(const ArrivalRule& rule, const DevoContext& context, Chance& chance)
      : rule_(rule), context_(context), chance_(chance), stays_(context.body.masses.size(), true) {
    if (rule.where != "by-stress") return;
    stress_ = rule.measure.of(context);
    lottery_ = StressLottery(stress_);
  }

  /// Sets whether a mass stays in the body. A mass that is about to be removed takes up no room, and new masses are not
  /// joined to it.
  void set_staying(std::uint32_t mass, bool stays) { stays_[mass] = stays; }

  /// Finds a free position for one more mass. Returns false if all attempts fail. With inherited draws, the places that
  /// are tried follow from how often this function was called before or, on springs, from the springs.
  bool find_position() {
    const std::uint64_t slot = slots_++;
    Rng* place = &chance_.stream({"place", slot});
    for (int attempt = 0; attempt < attempts_per_position; ++attempt) {
      Place found{{}, slot};
      std::optional<StressLottery::Drawn> drawn;
      if (!lottery_.empty()) {
        drawn = lottery_.draw(chance_);
        if (chance_.inherited()) found.key = mixed(chance_.key_of(drawn->spring), drawn->times);
        place = &chance_.stream({"along", found.key});
      }
      found.position = drawn ? position_on_spring(drawn->spring, *place) : position_in_bounds(*place);
      if (!is_free(found.position)) continue;
      places_.push_back(found);
      if (drawn) places_.back().cause = stress_[drawn->spring];
      return true;
    }
    return false;
  }

  /// Adds to `edits` one mass for each position found, and its springs. Returns false without adding anything if all
  /// masses that stay are air, because the new masses and all of their springs would be air too.
  bool come(Edits& edits) {
    auto partners = masses_where([&](std::uint32_t i) { return stays_[i]; });
    const auto models = masses_where([&](std::uint32_t i) { return stays_[i] && !is_of_air(i); });
    if (models.empty()) return false;
    for (const Place& place : places_) {
      const std::uint32_t model = chance_.one_of(models, {"model", place.key});
      NewMass mass{.material = context_.body.masses[model].material, .cause = place.cause};
      if (chance_.inherited()) mass.identity = mixed(context_.draws.origin(), place.key);
      join(edits.add_mass(place.position, mass), place, mass.material, partners, edits);
    }
    return true;
  }

 private:
  static constexpr int attempts_per_position = 100;

  /// Where a new mass comes, and what relatives recognise it by: the number of the search that found it or, on a
  /// spring, what stands for the spring and for how often it had been drawn before.
  struct Place {
    Vec3 position;
    std::uint64_t key;
    double cause = no_cause;  ///< stress of the spring
  };

  Vec3 position_in_bounds(Rng& rng) const {
    const auto& [low, high] = context_.bounds;
    return {rng.uniform(low.x, high.x), rng.uniform(low.y, high.y), rng.uniform(low.z, high.z)};
  }

  /// Returns a random position between the two ends of a spring, raised to the floor if masses have sunk into the
  /// floor.
  Vec3 position_on_spring(std::uint32_t index, Rng& rng) const {
    const Spring& spring = context_.body.springs[index];
    const Vec3 a = context_.position(spring.a), b = context_.position(spring.b);
    Vec3 position = a + rng.uniform() * (b - a);
    position.z = std::max(position.z, context_.bounds.low.z);
    return position;
  }

  /// Returns whether a position is far enough from all masses that stay and from all new masses.
  bool is_free(const Vec3& position) const {
    const auto is_near = [&](const Vec3& other) { return !(norm(position - other) >= rule_.min_distance); };
    if (std::any_of(places_.begin(), places_.end(), [&](const Place& place) { return is_near(place.position); }))
      return false;
    for (std::uint32_t i = 0; i < stays_.size(); ++i)
      if (stays_[i] && is_near(context_.position(i))) return false;
    return true;
  }

  /// Adds springs from a new mass to several of `partners`; changes the order of `partners`.
  void join(std::uint32_t newest, const Place& place, std::int32_t own, std::vector<std::uint32_t>& partners,
            Edits& edits) {
    const Body& body = context_.body;
    const auto count = static_cast<std::uint32_t>(partners.size());
    const bool random = rule_.join == "random", inherited = chance_.inherited();
    if (!random)
      sort_nearest_first(partners, static_cast<std::size_t>(rule_.springs), place.position, context_);
    else if (inherited)
      sort_by_number(partners, {"partner", place.key});
    for (std::uint32_t i = 0; i < std::min<std::int64_t>(count, rule_.springs); ++i) {
      if (random && !inherited) std::swap(partners[i], partners[i + chance_.rng().below(count - i)]);
      if (const auto mixed = material_between(body, own, body.masses[partners[i]].material)) {
        edits.join(partners[i], newest, *mixed);
      } else {
        const std::uint32_t model = random_spring(partners[i], place.key);
        const Spring& spring = body.springs[model];
        edits.join(partners[i], newest, body.materials[spring.material],
                   {.stiffness_factor = spring.stiffness_factor, .like = model});
      }
    }
  }

  /// Moves as many masses as a new mass is joined to to the front of `masses`: those with the smallest numbers.
  void sort_by_number(std::vector<std::uint32_t>& masses, const Tag& tag) const {
    std::vector<std::pair<double, std::uint32_t>> order;
    for (const std::uint32_t mass : masses) order.emplace_back(context_.draw(mass, tag), mass);
    const auto count = std::min(order.size(), static_cast<std::size_t>(rule_.springs));
    std::ranges::partial_sort(order, order.begin() + static_cast<std::ptrdiff_t>(count));
    std::ranges::transform(order, masses.begin(), [](const auto& item) { return item.second; });
  }

  /// Returns a random spring, after which a new spring between a mass and the one at the place of a key is made.
  std::uint32_t random_spring(std::uint32_t mass, std::uint64_t key) {
    if (!chance_.inherited()) return chance_.rng().below(static_cast<std::uint32_t>(context_.body.springs.size()));
    if (!ring_) ring_ = chance_.ring_of_springs();
    return ring_->at(context_.draw(mass, {"like", key}));
  }

  bool is_of_air(std::uint32_t mass) const {
    const std::int32_t material = context_.body.masses[mass].material;
    return material != no_material && is_air(context_.body.materials[material]);
  }

  template <class Predicate>
  std::vector<std::uint32_t> masses_where(Predicate predicate) const {
    std::vector<std::uint32_t> indices;
    for (std::uint32_t i = 0; i < stays_.size(); ++i)
      if (predicate(i)) indices.push_back(i);
    return indices;
  }

  const ArrivalRule& rule_;
  const DevoContext& context_;
  Chance& chance_;
  std::uint64_t slots_ = 0;     ///< how often a position was searched for
  std::vector<double> stress_;  ///< stress of every spring; empty unless it determines where masses are placed
  StressLottery lottery_;
  std::optional<Ring> ring_;  ///< of the springs, once one is drawn
  std::vector<bool> stays_;
  std::vector<Place> places_;
};

}  // namespace evodevo
