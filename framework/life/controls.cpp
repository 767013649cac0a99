#include "life/controls.hpp"

#include <algorithm>

#include "base/materials.hpp"
#include "life/edits.hpp"

namespace evodevo {
namespace {

std::vector<std::uint8_t> marked(const std::vector<std::uint32_t>& indices, std::size_t count) {
  std::vector<std::uint8_t> marks(count, 0);
  for (const std::uint32_t index : indices) marks.at(index) = 1;
  return marks;
}

std::optional<Material> mass_material(const Body& body, std::int32_t index) {
  if (index == no_material) return std::nullopt;
  return body.materials.at(static_cast<std::size_t>(index));
}

/// Springs or masses, grouped by material, to be drawn at random without replacement.
class Pools {
 public:
  /// Makes a pool for each of `materials` materials, and one for masses without a material.
  explicit Pools(std::size_t materials) : pools_(materials + 1) {}

  void add(std::int32_t material, std::uint32_t item) {
    pools_[index(material)].push_back(item);
    ++left_;
  }

  /// Draws an item of this material, or of any material if no item of this one is left. Returns nullopt if no item is
  /// left.
  std::optional<std::uint32_t> draw(std::int32_t material, Rng& rng) {
    if (left_ == 0) return std::nullopt;
    const std::size_t own = index(material);
    std::vector<std::uint32_t>& pool = own < pools_.size() && !pools_[own].empty() ? pools_[own] : any(rng);
    std::swap(pool[rng.below(static_cast<std::uint32_t>(pool.size()))], pool.back());
    const std::uint32_t item = pool.back();
    pool.pop_back();
    --left_;
    return item;
  }

 private:
  static std::size_t index(std::int32_t material) { return static_cast<std::size_t>(material - no_material); }

  /// Returns the pool of an item that is drawn at random from all pools; each item is equally likely.
  std::vector<std::uint32_t>& any(Rng& rng) {
    std::uint32_t item = rng.below(static_cast<std::uint32_t>(left_));
    auto pool = pools_.begin();
    for (; item >= pool->size(); ++pool) item -= static_cast<std::uint32_t>(pool->size());
    return *pool;
  }

  std::vector<std::vector<std::uint32_t>> pools_;
  std::size_t left_ = 0;
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
  RandomPlacement(const Amount& amount, const DevoContext& context, std::size_t& surplus, Rng& rng)
      : amount_(amount),
        context_(context),
        body_(context.body),
        numbers_(numbered(body_.materials)),
        surplus_(surplus),
        rng_(rng),
        mass_goes_(body_.masses.size(), 0),
        spring_goes_(body_.springs.size(), 0),
        staying_springs_(body_.materials.size()) {}

  Edits edits() {
    out_.growth = amount_.growth;
    remove_masses();
    remove_springs();
    change_springs();
    add_masses();
    add_springs();
    return std::move(out_);
  }

 private:
  void remove_masses() {
    Pools masses(body_.materials.size());
    for (std::uint32_t i = 0; i < body_.masses.size(); ++i) masses.add(body_.masses[i].material, i);
    for (const std::optional<Material>& material : amount_.masses_gone)
      if (const auto mass = masses.draw(index_in_body(material), rng_)) {
        out_.removed_masses.push_back(*mass);
        mass_goes_[*mass] = 1;
      }
  }

  void remove_springs() {
    for (const std::int32_t material : springs_due())
      if (const auto spring = staying_springs_.draw(material, rng_)) {
        out_.removed_springs.push_back(*spring);
        spring_goes_[*spring] = 1;
      }
  }

  /// Returns the materials of the springs to remove in addition to those of removed masses. Updates the surplus.
  std::vector<std::int32_t> springs_due() {
    std::vector<std::int32_t> due;
    for (const Material& material : amount_.springs_gone) due.push_back(index_in_body(material));
    for (std::uint32_t s = 0; s < body_.springs.size(); ++s) {
      const Spring& spring = body_.springs[s];
      const auto material = static_cast<std::int32_t>(spring.material);
      spring_goes_[s] = mass_goes_[spring.a] | mass_goes_[spring.b];
      if (spring_goes_[s] == 0)
        staying_springs_.add(material, s);
      else if (const auto same = std::find(due.begin(), due.end(), material); same != due.end())
        due.erase(same);
      else
        ++surplus_;
    }
    const std::size_t made_up = std::min(surplus_, due.size());
    rng_.shuffle(due);
    due.resize(due.size() - made_up);
    surplus_ -= made_up;
    return due;
  }

  void change_springs() {
    for (const Amount::SpringChange& change : amount_.springs_changed)
      if (const auto spring = staying_springs_.draw(index_in_body(change.before), rng_)) {
        ChangedSpring& changed = out_.changed_springs.emplace_back(ChangedSpring{.spring = *spring});
        changed.material = change.after;
        if (change.factor) changed.rest_length = *change.factor * body_.springs[*spring].rest_length;
      }
  }

  void add_masses() {
    const auto& [low, high] = context_.bounds;
    for (const Amount::MassCome& mass : amount_.masses_come) {
      const Vec3 position{rng_.uniform(low.x, high.x), rng_.uniform(low.y, high.y), rng_.uniform(low.z, high.z)};
      const std::int32_t material = index_in_body(mass.material);
      const bool is_known = material < static_cast<std::int32_t>(body_.materials.size());
      out_.new_masses.push_back({position, mass.mass, is_known ? material : no_material});
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
    const auto end = [&](const std::optional<std::uint32_t>& come) {
      if (come) return static_cast<std::uint32_t>(body_.masses.size() + *come);
      return staying[rng_.below(static_cast<std::uint32_t>(staying.size()))];
    };
    for (const Amount::SpringCome& spring : amount_.springs_come)
      for (std::size_t attempt = 0; attempt < attempts_per_spring; ++attempt) {
        const std::uint32_t first = end(spring.a), second = end(spring.b);
        const auto [a, b] = std::minmax(first, second);
        if (a == b || !(norm(position(b) - position(a)) > 0) || partners.joined(a, b)) continue;
        partners.join(a, b);
        out_.new_springs.push_back({a, b, spring.material, {}});
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

  const Amount& amount_;
  const DevoContext& context_;
  const Body& body_;
  MaterialNumbers numbers_;  ///< indices of the body's materials
  std::size_t& surplus_;
  Rng& rng_;
  Edits out_;
  std::vector<std::uint8_t> mass_goes_, spring_goes_;
  Pools staying_springs_;
};

}  // namespace

Amount amount_of(const Edits& edits, const Body& body, std::uint32_t op) {
  const std::vector<std::uint8_t> mass_goes = marked(edits.removed_masses, body.masses.size()),
                                  spring_goes = marked(edits.removed_springs, body.springs.size());
  Amount amount{.op = op, .growth = edits.growth};
  for (std::size_t s = 0; s < body.springs.size(); ++s) {
    const Spring& spring = body.springs[s];
    if (spring_goes[s] || mass_goes[spring.a] || mass_goes[spring.b])
      amount.springs_gone.push_back(body.materials[spring.material]);
  }
  for (std::size_t i = 0; i < body.masses.size(); ++i)
    if (mass_goes[i]) amount.masses_gone.push_back(mass_material(body, body.masses[i].material));
  for (const ChangedSpring& change : edits.changed_springs) {
    const Spring& spring = body.springs.at(change.spring);
    std::optional<double> factor;
    if (change.rest_length && spring.rest_length > 0) factor = *change.rest_length / spring.rest_length;
    amount.springs_changed.push_back({body.materials[spring.material], factor, change.material});
  }
  for (const NewMass& mass : edits.new_masses)
    amount.masses_come.push_back({mass.mass, mass_material(body, mass.material)});
  const auto new_mass = [&](std::uint32_t end) -> std::optional<std::uint32_t> {
    if (end < body.masses.size()) return std::nullopt;
    return static_cast<std::uint32_t>(end - body.masses.size());
  };
  for (const NewSpring& spring : edits.new_springs)
    amount.springs_come.push_back({spring.material, new_mass(spring.a), new_mass(spring.b)});
  return amount;
}

Edits at_random_places(const Amount& amount, const DevoContext& context, std::size_t& surplus, Rng& rng) {
  return RandomPlacement(amount, context, surplus, rng).edits();
}

std::vector<Amount> Yoke::amounts_after(int cycle) {
  std::vector<Amount> amounts;
  for (; next_ < changes_.size() && changes_[next_].cycle == static_cast<std::uint32_t>(cycle); ++next_) {
    const Change& change = changes_[next_];
    if (change.op) amounts.push_back(amount_of(change.edits, body_, *change.op));
    apply(change.edits, body_);
  }
  std::stable_partition(amounts.begin(), amounts.end(),
                        [](const Amount& amount) { return !amount.masses_gone.empty(); });
  return amounts;
}

}  // namespace evodevo
