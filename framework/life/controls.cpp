#include "life/controls.hpp"

#include <algorithm>
#include <functional>
#include <map>

#include "base/materials.hpp"
#include "life/edits.hpp"

namespace evodevo {
namespace {

std::vector<std::uint8_t> marked(const std::vector<Removal>& removals, std::size_t count) {
  std::vector<std::uint8_t> marks(count, 0);
  for (const Removal& removal : removals) marks.at(removal.index) = 1;
  return marks;
}

std::optional<Material> mass_material(const Body& body, std::int32_t index) {
  if (index == no_material) return std::nullopt;
  return body.materials.at(static_cast<std::size_t>(index));
}

/// Springs or masses, grouped by kind, to be drawn at random without replacement.
class Pools {
 public:
  /// Makes a pool for each of `kinds` kinds, and one for masses without a material. With inherited draws,
  /// `number(item)` decides: the item with the smallest number is drawn first.
  Pools(std::size_t kinds, Chance& chance, std::function<double(std::uint32_t)> number)
      : pools_(kinds + 1), chance_(chance), number_(std::move(number)) {}

  void add(std::int32_t kind, std::uint32_t item) {
    pools_[index(kind)].emplace_back(chance_.inherited() ? number_(item) : 0, item);
    ++left_;
    is_sorted_ = !chance_.inherited();
  }

  /// Draws an item of this kind, or of any kind if no item of this one is left. Returns nullopt if no item is left.
  std::optional<std::uint32_t> draw(std::int32_t kind) {
    if (left_ == 0) return std::nullopt;
    if (!std::exchange(is_sorted_, true))
      for (Pool& pool : pools_) std::ranges::sort(pool, std::greater());
    const std::size_t own = index(kind);
    Pool& pool = own < pools_.size() && !pools_[own].empty() ? pools_[own] : any();
    if (!chance_.inherited())
      std::swap(pool[chance_.rng().below(static_cast<std::uint32_t>(pool.size()))], pool.back());
    const std::uint32_t item = pool.back().second;
    pool.pop_back();
    --left_;
    return item;
  }

 private:
  using Pool = std::vector<std::pair<double, std::uint32_t>>;  ///< numbers and items

  static std::size_t index(std::int32_t kind) { return static_cast<std::size_t>(kind - no_material); }

  /// Returns the pool of an item that is drawn at random from all pools; each item is equally likely.
  Pool& any() {
    if (chance_.inherited())
      return *std::ranges::min_element(pools_, {},
                                       [](const Pool& pool) { return pool.empty() ? 2 : pool.back().first; });
    std::uint32_t item = chance_.rng().below(static_cast<std::uint32_t>(left_));
    auto pool = pools_.begin();
    for (; item >= pool->size(); ++pool) item -= static_cast<std::uint32_t>(pool->size());
    return *pool;
  }

  std::vector<Pool> pools_;
  Chance& chance_;
  std::function<double(std::uint32_t)> number_;
  std::size_t left_ = 0;
  bool is_sorted_ = true;
};

/// The pairs of masses that are joined.
class Partners {
 public:
  explicit Partners(std::size_t masses) : partners_(masses) {}

  void join(std::uint32_t a, std::uint32_t b) {
    partners_[a].push_back(b);
    partners_[b].push_back(a);
  }
  bool joined(std::uint32_t a, std::uint32_t b) const {
    return std::find(partners_[a].begin(), partners_[a].end(), b) != partners_[a].end();
  }

 private:
  std::vector<std::vector<std::uint32_t>> partners_;
};

/// Places one amount of change at random in a body.
class RandomPlacement {
 public:
  RandomPlacement(const Amount& amount, const DevoContext& context, std::size_t& surplus, Chance& chance)
      : amount_(amount),
        context_(context),
        body_(context.body),
        numbers_(numbered(body_.materials)),
        kinds_(kinds_of(body_)),
        surplus_(surplus),
        chance_(chance),
        out_(body_),
        mass_goes_(body_.masses.size(), 0),
        spring_goes_(body_.springs.size(), 0),
        staying_springs_(kinds_.size(), chance, [this](std::uint32_t s) { return chance_.number_of(s, "spring"); }) {}

  Edits edits() {
    out_.scaling = amount_.scaling;
    remove_masses();
    remove_springs();
    change_springs();
    add_masses();
    add_springs();
    return std::move(out_);
  }

 private:
  void remove_masses() {
    Pools masses(body_.materials.size(), chance_, [this](std::uint32_t i) { return context_.draw(i, "mass"); });
    for (std::uint32_t i = 0; i < body_.masses.size(); ++i) masses.add(body_.masses[i].material, i);
    for (const std::optional<Material>& material : amount_.masses_gone)
      if (const auto mass = masses.draw(index_in_body(material))) {
        out_.remove_mass(*mass);
        mass_goes_[*mass] = 1;
      }
  }

  void remove_springs() {
    for (const std::int32_t kind : springs_due())
      if (const auto spring = staying_springs_.draw(kind)) {
        out_.remove_spring(*spring);
        spring_goes_[*spring] = 1;
      }
  }

  /// Returns the kinds of the springs to remove in addition to those of removed masses. Updates the surplus.
  std::vector<std::int32_t> springs_due() {
    std::vector<std::int32_t> due;
    for (const Amount::SpringKind& kind : amount_.springs_gone) due.push_back(kind_in_body(kind));
    for (std::uint32_t s = 0; s < body_.springs.size(); ++s) {
      const Spring& spring = body_.springs[s];
      const std::int32_t kind = kind_in_body({body_.materials[spring.material], spring.stiffness_factor});
      spring_goes_[s] = mass_goes_[spring.a] | mass_goes_[spring.b];
      if (spring_goes_[s] == 0)
        staying_springs_.add(kind, s);
      else if (const auto same = std::find(due.begin(), due.end(), kind); same != due.end())
        due.erase(same);
      else
        ++surplus_;
    }
    const std::size_t made_up = std::min(surplus_, due.size());
    // with inherited draws, the order says only who is left out
    if (made_up > 0 || !chance_.inherited()) chance_.stream("due").shuffle(due);
    due.resize(due.size() - made_up);
    surplus_ -= made_up;
    return due;
  }

  void change_springs() {
    for (const Amount::SpringChange& change : amount_.springs_changed)
      if (const auto spring = staying_springs_.draw(kind_in_body(change.before))) {
        ChangedSpring changed{.material = change.material, .stiffness_factor = change.stiffness_factor};
        if (change.length) changed.rest_length = *change.length * body_.springs[*spring].rest_length;
        out_.change_spring(*spring, changed);
      }
  }

  void add_masses() {
    const auto& [low, high] = context_.bounds;
    for (const Amount::MassCome& mass : amount_.masses_come) {
      Rng& rng = chance_.stream({"place", out_.new_masses.size()});
      const Vec3 position{rng.uniform(low.x, high.x), rng.uniform(low.y, high.y), rng.uniform(low.z, high.z)};
      const std::int32_t material = index_in_body(mass.material);
      const bool is_known = material < static_cast<std::int32_t>(body_.materials.size());
      out_.add_mass(position, {.mass = mass.mass, .material = is_known ? material : no_material});
    }
  }

  void add_springs() {
    std::vector<std::uint32_t> staying;
    for (std::uint32_t i = 0; i < mass_goes_.size(); ++i)
      if (mass_goes_[i] == 0) staying.push_back(i);
    if (amount_.springs_come.empty() || staying.empty()) return;
    Partners partners(body_.masses.size() + out_.new_masses.size());
    for (std::uint32_t s = 0; s < spring_goes_.size(); ++s)
      if (spring_goes_[s] == 0) partners.join(body_.springs[s].a, body_.springs[s].b);
    const Ring ring = chance_.inherited() ? chance_.ring_of(staying) : Ring();
    const auto end = [&](const std::optional<std::uint32_t>& come, const Tag& tag) {
      if (come) return static_cast<std::uint32_t>(body_.masses.size() + *come);
      return chance_.inherited() ? ring.at(context_.draw(tag))
                                 : staying[chance_.rng().below(static_cast<std::uint32_t>(staying.size()))];
    };
    std::uint64_t attempts = 0;
    for (const Amount::SpringCome& spring : amount_.springs_come)
      for (std::size_t attempt = 0; attempt < attempts_per_spring; ++attempt, ++attempts) {
        const std::uint32_t first = end(spring.a, {"first", attempts}), second = end(spring.b, {"second", attempts});
        const auto [a, b] = std::minmax(first, second);
        if (a == b || !(norm(position(b) - position(a)) > 0) || partners.joined(a, b)) continue;
        partners.join(a, b);
        out_.join(a, b, spring.kind.material, {.stiffness_factor = spring.kind.stiffness_factor});
        break;
      }
  }

  /// The position of an old or new mass at the start of the next cycle, m.
  Vec3 position(std::uint32_t mass) const {
    const std::size_t old = body_.masses.size();
    return mass < old ? context_.position(mass) : out_.new_masses.at(mass - old).position;
  }

  /// Returns the index of a material; one past the last index if the body does not have the material.
  std::int32_t index_in_body(const std::optional<Material>& material) const {
    if (!material) return no_material;
    const auto found = numbers_.find(*material);
    return static_cast<std::int32_t>(found != numbers_.end() ? found->second : body_.materials.size());
  }

  using Kinds = std::map<std::pair<std::uint32_t, double>, std::int32_t>;

  /// Numbers the kinds of a body's springs, by the index of their material among numbers_ and their stiffness factor.
  Kinds kinds_of(const Body& body) const {
    Kinds kinds;
    for (const Spring& spring : body.springs)
      kinds.try_emplace({numbers_.at(body.materials[spring.material]), spring.stiffness_factor},
                        static_cast<std::int32_t>(kinds.size()));
    return kinds;
  }

  /// Returns the number of a kind; one past the last number if the body has no such spring.
  std::int32_t kind_in_body(const Amount::SpringKind& kind) const {
    const auto beyond = static_cast<std::int32_t>(kinds_.size());
    const auto material = numbers_.find(kind.material);
    if (material == numbers_.end()) return beyond;
    const auto found = kinds_.find({material->second, kind.stiffness_factor});
    return found != kinds_.end() ? found->second : beyond;
  }

  const Amount& amount_;
  const DevoContext& context_;
  const Body& body_;
  MaterialNumbers numbers_;  ///< indices of the body's materials
  Kinds kinds_;
  std::size_t& surplus_;
  Chance& chance_;
  Edits out_;
  std::vector<std::uint8_t> mass_goes_, spring_goes_;
  Pools staying_springs_;
};

}  // namespace

Amount amount_of(const Edits& edits, const Body& body, std::uint32_t op) {
  const std::vector<std::uint8_t> mass_goes = marked(edits.removed_masses, body.masses.size()),
                                  spring_goes = marked(edits.removed_springs, body.springs.size());
  Amount amount{.op = op, .scaling = edits.scaling};
  const auto kind_of = [&](const Spring& spring) {
    return Amount::SpringKind{body.materials[spring.material], spring.stiffness_factor};
  };
  for (std::size_t s = 0; s < body.springs.size(); ++s) {
    const Spring& spring = body.springs[s];
    if (spring_goes[s] || mass_goes[spring.a] || mass_goes[spring.b]) amount.springs_gone.push_back(kind_of(spring));
  }
  for (std::size_t i = 0; i < body.masses.size(); ++i)
    if (mass_goes[i]) amount.masses_gone.push_back(mass_material(body, body.masses[i].material));
  for (const ChangedSpring& change : edits.changed_springs) {
    const Spring& spring = body.springs.at(change.spring);
    std::optional<double> length;
    if (change.rest_length && spring.rest_length > 0) length = *change.rest_length / spring.rest_length;
    amount.springs_changed.push_back({kind_of(spring), length, change.material, change.stiffness_factor});
  }
  for (const NewMass& mass : edits.new_masses)
    amount.masses_come.push_back({mass.mass.value(), mass_material(body, mass.material)});
  const auto new_mass = [&](std::uint32_t end) -> std::optional<std::uint32_t> {
    if (end < body.masses.size()) return std::nullopt;
    return static_cast<std::uint32_t>(end - body.masses.size());
  };
  for (const NewSpring& spring : edits.new_springs)
    amount.springs_come.push_back({{spring.material, spring.stiffness_factor}, new_mass(spring.a), new_mass(spring.b)});
  return amount;
}

Edits at_random_places(const Amount& amount, const DevoContext& context, std::size_t& surplus, Chance& chance) {
  return RandomPlacement(amount, context, surplus, chance).edits();
}

std::vector<Amount> Yoke::amounts_after(int cycle) {
  std::vector<Amount> amounts;
  for (; next_ < changes_.size() && changes_[next_].cycle == static_cast<std::uint32_t>(cycle); ++next_) {
    const Change& change = changes_[next_];
    if (change.op) amounts.push_back(amount_of(change.edits, living_.body, *change.op));
    apply(change.edits, living_, change.op);
  }
  std::stable_partition(amounts.begin(), amounts.end(),
                        [](const Amount& amount) { return !amount.masses_gone.empty(); });
  return amounts;
}

}  // namespace evodevo
