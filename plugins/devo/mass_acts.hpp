// What the masses of a body can do by themselves, and the limits within which they do it.
#pragma once

#include <array>
#include <cmath>
#include <set>

#include "evodevo/helpers/adaptation.hpp"
#include "evodevo/helpers/chance.hpp"
#include "evodevo/helpers/materials.hpp"
#include "evodevo/helpers/partners.hpp"

namespace evodevo {

/// What a mass can do, in the order of the network's outputs. The outputs after these are what the mass remembers.
enum Action : std::size_t { divide, stiffen, let_go, reach, actions };
inline constexpr std::array<const char*, actions> action_names = {"divide", "stiffen", "let go", "reach"};

/// The parameters that limit what masses do.
struct ActLimits {
  std::int64_t masses_per_action = 10;
  std::int64_t masses = 2000;
  std::int64_t springs_of_daughter = 6;
  std::int64_t least_springs = 3, most_springs = 30;
  double distance = 0.5;
  double min_distance = 0.02;  ///< m
  double rate = 0.1;
  double low = 1000, high = 20'000;  ///< N/m

  void declare(Parameters& p) {
    p.integer(
        masses_per_action, "actions", {1, 100'000, "1"},
        "Largest number of masses that divide at one application; likewise of masses that stiffen or soften their "
        "springs, that let a spring go, and that reach for a new one.");
    p.integer(masses, "limit", {0, 10'000'000, "1"}, "Largest number of masses to which a body grows.");
    p.integer(springs_of_daughter, "springs", {1, 1000, "1"},
              "Number of springs of a daughter mass: one to her mother, the others to those of the mother's partners "
              "that are nearest to the daughter.");
    p.integer(least_springs, "least_springs", {1, 100'000, "1"},
              "Number of springs that each mass keeps when springs are let go.");
    p.integer(most_springs, "most_springs", {1, 100'000, "1"}, "Number of springs at which a mass gets no more.");
    p.real(distance, "distance", {0.01, 10, "1"},
           "Distance between a daughter and her mother, relative to the mean length of the mother's springs.");
    p.real(min_distance, "min_distance", {0, 100, "m"}, "Smallest distance between a new mass and any other mass.");
    p.real(rate, "rate", {0, 1, "1"},
           "Change of ln(stiffness) of a spring if the network of one of its masses outputs 1.");
    p.real(low, "low", {1e-3, 1e9, "N/m"}, "Stiffness below which no spring is softened.");
    p.real(high, "high", {1e-3, 1e9, "N/m"}, "Stiffness above which no spring is stiffened.");
    p.require(springs_of_daughter <= most_springs, "springs", "expected at most `most_springs`");
    p.require(low <= high, "low", "expected at most `high`");
  }
};

/// Several numbers, in columns, for each mass.
class Table {
 public:
  Table(std::size_t masses, std::size_t columns) : values_(masses * columns), columns_(columns) {}
  double& at(std::size_t mass, std::size_t column) { return values_[mass * columns_ + column]; }
  double at(std::size_t mass, std::size_t column) const { return values_[mass * columns_ + column]; }
  std::span<const double> row(std::size_t mass) const { return std::span(values_).subspan(mass * columns_, columns_); }
  std::size_t columns() const { return columns_; }

 private:
  std::vector<double> values_;
  std::size_t columns_;
};

/// Does what masses want to do, and writes it to edits. Masses act in the order of their outputs, largest first, ties
/// by DevoContext::rank(). One that a limit holds back gives its turn to the next.
class MassActs {
 public:
  MassActs(const ActLimits& limits, const DevoContext& context, const Table& out, Edits& edits)
      : limits_(limits),
        context_(context),
        body_(context.body),
        out_(out),
        edits_(edits),
        partners_(context.body),
        gone_(context.body.springs.size(), false) {
    for (std::uint32_t i = 0; i < body_.masses.size(); ++i)
      springs_.push_back(static_cast<std::int64_t>(partners_.of(i).size()));
  }

  /// Each mass lets the least stressed of its springs go that may go.
  void let_springs_go() {
    each_willing(let_go, [&](std::uint32_t mass) {
      const auto spring = least_stressed_that_may_go(mass);
      if (!spring) return false;
      gone_[*spring] = true;
      --springs_[body_.springs[*spring].a];
      --springs_[body_.springs[*spring].b];
      edits_.remove_spring(*spring, {.cause = out_.at(mass, let_go)});
      return true;
    });
  }

  /// Each mass reaches for the nearest mass that it is not joined to.
  void reach_for_others() {
    each_willing(reach, [&](std::uint32_t mass) {
      const auto other = can_get_one(mass) ? nearest_free(mass) : std::nullopt;
      const auto tissue = other ? tissue_between(mass, *other) : std::nullopt;
      if (!tissue) return false;
      reached_.insert(std::minmax(mass, *other));
      join(mass, *other, *tissue, out_.at(mass, reach));
      ++springs_[*other];
      return true;
    });
  }

  /// Each mass divides; its daughter lies on the side that is away from the centre of its partners.
  void divide_masses(Chance& chance) {
    each_willing(divide, [&](std::uint32_t mother) {
      const bool has_room = static_cast<std::int64_t>(masses()) < limits_.masses;
      if (!has_room || !can_get_one(mother) || partners_.of(mother).empty()) return false;
      const Vec3 position = place_beside(mother, chance);
      return !is_crowded(position) && bear(mother, position);
    });
  }

  /// Each mass stiffens its springs if its output is positive, and softens them if it is negative.
  void change_stiffness() {
    std::vector<double> push(body_.masses.size());
    Order order(context_, [&](std::uint32_t i) { return std::abs(out_.at(i, stiffen)); });
    for (std::int64_t acted = 0; acted < limits_.masses_per_action && !order.empty(); ++acted) {
      const std::uint32_t mass = order.next();
      push[mass] = out_.at(mass, stiffen);
    }
    for (std::uint32_t s = 0; s < body_.springs.size(); ++s) {
      const double sum = push[body_.springs[s].a] + push[body_.springs[s].b];
      if (gone_[s] || sum == 0) continue;
      const double before = body_.stiffness(body_.springs[s]),
                   after = within_bounds(before, before * std::exp(limits_.rate * sum), limits_.low, limits_.high);
      if (const auto change = with_stiffness(body_, s, after, sum)) edits_.change_spring(s, *change);
    }
  }

 private:
  std::size_t masses() const { return body_.masses.size() + edits_.new_masses.size(); }
  /// The number by which ties between the springs of a mass are broken, smallest first: with inherited draws the
  /// identity of the other mass, otherwise the index of the spring.
  std::uint64_t rank_at(std::uint32_t mass, std::uint32_t spring) const {
    const Spring& s = body_.springs[spring];
    return context_.draws.inherited() ? context_.identity(s.a == mass ? s.b : s.a) : spring;
  }
  bool can_lose_one(std::uint32_t mass) const { return springs_[mass] > limits_.least_springs; }
  bool can_get_one(std::uint32_t mass) const { return springs_[mass] < limits_.most_springs; }

  /// Masses that try to act, for each that may: enough for others to take the turns of those that are held back.
  static constexpr std::int64_t tries_per_action = 4;

  /// The masses with positive keys, largest first.
  class Order {
   public:
    template <class Key>
    Order(const DevoContext& context, const Key& key) {
      for (std::uint32_t i = 0; i < context.body.masses.size(); ++i)  // of equals, the lowest rank wins
        if (const double value = key(i); value > 0) left_.emplace_back(value, ~context.rank(i), i);
      std::make_heap(left_.begin(), left_.end());
    }
    bool empty() const { return left_.empty(); }
    std::uint32_t next() {
      std::pop_heap(left_.begin(), left_.end());
      const std::uint32_t mass = std::get<2>(left_.back());
      left_.pop_back();
      return mass;
    }

   private:
    std::vector<std::tuple<double, std::uint64_t, std::uint32_t>> left_;
  };

  /// Calls act(mass), which returns whether the mass has acted, for the masses whose output is positive, until as many
  /// have acted as may.
  template <class Act>
  void each_willing(Action action, const Act& act) {
    Order order(context_, [&](std::uint32_t i) { return out_.at(i, action); });
    std::int64_t acted = 0;
    for (std::int64_t tried = 0; acted < limits_.masses_per_action && !order.empty(); ++tried) {
      if (tried == tries_per_action * limits_.masses_per_action) return;
      if (act(order.next())) ++acted;
    }
  }

  /// Returns the spring of a mass with the least stress among those that both of their masses can lose; ties by
  /// rank_at(). A stress of NaN counts as the largest.
  std::optional<std::uint32_t> least_stressed_that_may_go(std::uint32_t mass) const {
    std::optional<std::uint32_t> found;
    std::pair<double, std::uint64_t> least;
    for (const std::uint32_t s : partners_.springs_of(mass)) {
      if (gone_[s] || !can_lose_one(body_.springs[s].a) || !can_lose_one(body_.springs[s].b)) continue;
      const double stress =
          std::isnan(context_.stress[s]) ? std::numeric_limits<double>::infinity() : context_.stress[s];
      const std::pair key(stress, rank_at(mass, s));
      if (found && !(key < least)) continue;
      found = s;
      least = key;
    }
    return found;
  }

  /// Returns the nearest mass that another one can be joined to, if there is one; ties by
  /// DevoContext::rank().
  std::optional<std::uint32_t> nearest_free(std::uint32_t mass) const {
    std::optional<std::uint32_t> found;
    std::pair least(std::numeric_limits<double>::infinity(), std::uint64_t{0});
    const Vec3 here = context_.position(mass);
    for (std::uint32_t i = 0; i < body_.masses.size(); ++i) {
      const Vec3 way = context_.position(i) - here;
      const std::pair key(dot(way, way), context_.rank(i));
      if (!(key.first > 0 && key < least) || !can_get_one(i) || partners_.joined(mass, i) ||
          reached_.contains(std::minmax(mass, i)))
        continue;
      least = key;
      found = i;
    }
    return found;
  }

  /// What a new spring is made of.
  struct Tissue {
    Material material;
    std::optional<std::uint32_t> like = {};  ///< the spring from which it comes; none: it is mixed
  };

  /// Returns the tissue of a new spring: the mean of the materials of its masses or, if one has none, the tissue of the
  /// first spring of `mass` by rank_at(); nothing if that is air, or if there is no spring.
  std::optional<Tissue> tissue_between(std::uint32_t mass, std::uint32_t other) const {
    std::optional<Tissue> tissue;
    if (const auto mixed = material_between(body_, body_.masses[mass].material, body_.masses[other].material)) {
      tissue = {*mixed};
    } else if (const auto own = partners_.springs_of(mass); !own.empty()) {
      const std::uint32_t model =
          *std::ranges::min_element(own, {}, [&](std::uint32_t spring) { return rank_at(mass, spring); });
      tissue = {body_.materials[body_.springs[model].material], model};
    }
    return tissue && !is_air(tissue->material) ? tissue : std::nullopt;
  }

  /// Adds a spring from a mass of the body to another mass.
  void join(std::uint32_t mass, std::uint32_t other, const Tissue& tissue, double cause) {
    edits_.join(mass, other, tissue.material, {.like = tissue.like, .cause = cause});
    ++springs_[mass];
  }

  /// Returns the position of a daughter: away from the centre of the mother's partners, but not below the floor. If the
  /// mother is at their centre, the direction is random.
  Vec3 place_beside(std::uint32_t mother, Chance& chance) const {
    const Vec3 here = context_.position(mother);
    Vec3 away;
    double lengths = 0;
    for (const std::uint32_t partner : partners_.of(mother)) {
      const Vec3 way = here - context_.position(partner);
      away = away + way;
      lengths += norm(way);
    }
    if (!(lengths > 0) || !std::isfinite(lengths)) return here;
    // what rounding leaves of a sum of zero is no direction
    if (!(norm(away) > 1e-9 * lengths)) {
      Rng& rng = chance.stream("direction", {context_.identity(mother)});
      away = lengths * Vec3{rng.normal(), rng.normal(), rng.normal()};
    }
    const double distance = limits_.distance * lengths / static_cast<double>(partners_.of(mother).size());
    Vec3 position = here + distance / norm(away) * away;
    position.z = std::max(position.z, context_.bounds.low.z);
    return position;
  }

  bool is_crowded(const Vec3& position) const {
    // written so that NaN is refused, and so is a daughter at the place of another mass
    const auto is_near = [&](const Vec3& other) {
      const Vec3 way = position - other;
      return !(dot(way, way) > 0 && dot(way, way) >= limits_.min_distance * limits_.min_distance);
    };
    for (const NewMass& mass : edits_.new_masses)
      if (is_near(mass.position)) return true;
    for (std::uint32_t i = 0; i < body_.masses.size(); ++i)
      if (is_near(context_.position(i))) return true;
    return false;
  }

  /// Adds a daughter with the mother's material and memory, joined to the mother and to her partners that are nearest
  /// to the daughter. Returns whether there is something to make her springs of.
  bool bear(std::uint32_t mother, const Vec3& position) {
    const auto to_mother = tissue_between(mother, mother);
    if (!to_mother) return false;
    const double cause = out_.at(mother, divide);
    const std::uint32_t daughter =
        edits_.divide(mother, position, {.material = body_.masses[mother].material, .cause = cause});
    edits_.remember_mass(daughter, out_.row(mother).subspan(actions));
    join(mother, daughter, *to_mother, cause);
    std::vector<std::uint32_t> others;
    for (const std::uint32_t partner : partners_.of(mother))
      if (can_get_one(partner)) others.push_back(partner);
    std::ranges::sort(others);  // a partner is there once for each of several parallel springs
    others.erase(std::ranges::unique(others).begin(), others.end());
    const auto count = static_cast<std::size_t>(limits_.springs_of_daughter - 1);
    sort_nearest_first(others, count, position, context_);
    others.resize(std::min(others.size(), count));
    for (const std::uint32_t other : others)
      join(other, daughter, tissue_between(mother, other).value_or(*to_mother), cause);
    return true;
  }

  const ActLimits& limits_;
  const DevoContext& context_;
  const Body& body_;
  const Table& out_;
  Edits& edits_;
  Partners partners_;
  std::vector<std::int64_t> springs_;  ///< number of springs of each mass of the body, counting what was done so far
  std::vector<bool> gone_;             ///< which springs have been let go
  std::set<std::pair<std::uint32_t, std::uint32_t>> reached_;  ///< pairs that new springs join
};

}  // namespace evodevo
