#include "controls.hpp"

#include <map>
#include <numeric>
#include <unordered_set>

#include "development.hpp"

namespace evodevo {
namespace {

/// One application of edits at other places than those that they name.
class Relocation {
 public:
  Relocation(const Edits& edits, const Moment& now, Rng& rng) : edits_(edits), now_(now), rng_(rng) {}

  Edits relocate() {
    remove_masses();
    remove_springs();
    change_springs();
    add_masses();
    add_springs();
    return std::move(out_);
  }

 private:
  void remove_masses() {
    staying_masses_.resize(now_.body.masses.size());
    std::iota(staying_masses_.begin(), staying_masses_.end(), 0u);
    out_.removed_masses = take(staying_masses_, distinct(edits_.removed_masses));
  }

  void remove_springs() {
    const std::unordered_set<std::uint32_t> gone(out_.removed_masses.begin(), out_.removed_masses.end());
    const auto& springs = now_.body.springs;
    for (std::uint32_t s = 0; s < springs.size(); ++s)
      if (!gone.contains(springs[s].a) && !gone.contains(springs[s].b)) staying_springs_.push_back(s);
    out_.removed_springs = take(staying_springs_, distinct(edits_.removed_springs));
  }

  void change_springs() {
    if (edits_.changed_springs.empty()) return;
    const auto& springs = now_.body.springs;
    std::map<std::uint32_t, std::vector<std::uint32_t>> of_material;
    for (const std::uint32_t s : staying_springs_) of_material[springs[s].material].push_back(s);
    for (const ChangedSpring& change : edits_.changed_springs) {
      const Spring& before = springs.at(change.spring);
      for (const std::uint32_t s : take(of_material[before.material], 1)) {
        ChangedSpring& moved = out_.changed_springs.emplace_back(change);
        moved.spring = s;
        if (change.rest_length && before.rest_length > 0)
          moved.rest_length = springs[s].rest_length * (*change.rest_length / before.rest_length);
      }
    }
  }

  void add_masses() {
    const auto& [low, high] = now_.bounds;
    out_.new_masses = edits_.new_masses;
    for (NewMass& mass : out_.new_masses)
      mass.place = {rng_.uniform(low.x, high.x), rng_.uniform(low.y, high.y), rng_.uniform(low.z, high.z)};
  }

  void add_springs() {
    if (edits_.new_springs.empty() || staying_masses_.empty()) return;
    std::unordered_set<std::uint64_t> joined;
    for (const std::uint32_t s : staying_springs_)
      joined.insert(pair_key(now_.body.springs[s].a, now_.body.springs[s].b));
    for (const NewSpring& spring : edits_.new_springs)
      for (std::size_t attempt = 0; attempt < attempts_per_spring; ++attempt) {
        const std::uint32_t a = other_end(spring.a), b = other_end(spring.b);
        if (a == b || !(norm(place(b) - place(a)) > 0) || !joined.insert(pair_key(a, b)).second) continue;
        out_.new_springs.push_back({a, b, spring.material, {}});
        break;
      }
  }

  /// A random mass that stays in the place of an old one; a new one stays what it is.
  std::uint32_t other_end(std::uint32_t end) {
    if (end >= now_.body.masses.size()) return end;
    return staying_masses_[rng_.below(static_cast<std::uint32_t>(staying_masses_.size()))];
  }

  Vec3 place(std::uint32_t mass) const {
    const std::size_t old = now_.body.masses.size();
    return mass < old ? now_.place(mass) : out_.new_masses.at(mass - old).place;
  }

  static std::size_t distinct(const std::vector<std::uint32_t>& indices) {
    return std::unordered_set<std::uint32_t>(indices.begin(), indices.end()).size();
  }

  /// Takes `count` random ones, or all, out of `pool`, whose order changes.
  std::vector<std::uint32_t> take(std::vector<std::uint32_t>& pool, std::size_t count) {
    std::vector<std::uint32_t> taken;
    while (taken.size() < count && !pool.empty()) {
      std::swap(pool[rng_.below(static_cast<std::uint32_t>(pool.size()))], pool.back());
      taken.push_back(pool.back());
      pool.pop_back();
    }
    return taken;
  }

  const Edits& edits_;
  const Moment& now_;
  Rng& rng_;
  Edits out_;
  std::vector<std::uint32_t> staying_masses_, staying_springs_;
};

}  // namespace

Edits at_random_places(const Edits& edits, const Moment& now, Rng& rng) {
  return Relocation(edits, now, rng).relocate();
}

}  // namespace evodevo
