// "Remove masses that fall below a threshold and add a new mass with the base amount of springs" (paper, section
// IV-D3).
#include <optional>

#include "evodevo/plugin.hpp"

namespace {

using evodevo::Body;
using evodevo::Box;
using evodevo::Edits;
using evodevo::Material;
using evodevo::Moment;
using evodevo::no_material;
using evodevo::Rng;
using evodevo::Vec3;

/// The paper's operation, "currently partially implemented" there, with the choices that it leaves open. Masses are
/// judged once, before any goes; springs of air count, since a body with much air would be wiped out otherwise; at
/// most `limit` and half of the body go at once, fewest springs first. A mass for which no free place is found stays.
/// A new mass has the material of a random mass that stays and is not air; where masses have no material, its springs
/// have those of random springs of the body.
class MassTurnover final : public evodevo::Devo {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.integer(threshold_, "threshold", {0, 100'000, "1"}, "Masses with fewer springs than these go.");
    p.integer(limit_, "limit", {0, 100'000, "1"}, "Masses that go in one cycle at most.");
    p.integer(springs_, "springs", {1, 100'000, "1"}, "Springs of a new mass, to random masses that stay.");
    p.real(min_distance_, "min_distance", {0, 100, "m"}, "Distance of a new mass from any other at least.");
  }

  void develop(const Moment& now, Edits& edits, Rng& rng) const override {
    const auto leaving = poorest(now.body, rng);
    if (leaving.empty() || now.body.springs.empty()) return;

    std::vector<bool> stays(now.body.masses.size(), true);
    std::vector<std::uint32_t> removed;
    std::vector<Vec3> places;
    for (const std::uint32_t mass : leaving) {
      stays[mass] = false;
      if (const auto place = free_place(now, stays, places, rng)) {
        removed.push_back(mass);
        places.push_back(*place);
      } else {
        stays[mass] = true;
      }
    }

    auto partners = indices_where(now.body, [&](std::uint32_t i) { return stays[i]; });
    const auto models = indices_where(now.body, [&](std::uint32_t i) { return stays[i] && !is_air(now.body, i); });
    if (models.empty()) return;  // all that stay is air, to which nothing can be joined
    edits.removed_masses = removed;
    for (const Vec3& place : places) {
      const auto model = models[rng.below(static_cast<std::uint32_t>(models.size()))];
      edits.new_masses.push_back({place, now.mass, now.body.masses[model].material});
      join(now.body, partners, edits, rng);
    }
  }

 private:
  static constexpr int attempts_per_place = 100;

  /// The masses below the threshold that may go, fewest springs first, ties in random order.
  std::vector<std::uint32_t> poorest(const Body& body, Rng& rng) const {
    std::vector<std::int64_t> valence;
    for (const auto& mass : body.masses) valence.push_back(mass.air_contacts);
    for (const auto& spring : body.springs) {
      ++valence[spring.a];
      ++valence[spring.b];
    }
    auto poor = indices_where(body, [&](std::uint32_t i) { return valence[i] < threshold_; });
    rng.shuffle(poor);
    std::stable_sort(poor.begin(), poor.end(), [&](auto a, auto b) { return valence[a] < valence[b]; });
    poor.resize(std::min({poor.size(), static_cast<std::size_t>(limit_), body.masses.size() / 2}));
    return poor;
  }

  /// A random place in bounds, far enough from all masses that stay and from the new ones; none if many tries fail.
  std::optional<Vec3> free_place(const Moment& now, const std::vector<bool>& stays, const std::vector<Vec3>& added,
                                 Rng& rng) const {
    const Box& bounds = now.bounds;
    for (int attempt = 0; attempt < attempts_per_place; ++attempt) {
      const Vec3 place{rng.uniform(bounds.low.x, bounds.high.x), rng.uniform(bounds.low.y, bounds.high.y),
                       rng.uniform(bounds.low.z, bounds.high.z)};
      const auto is_near = [&](const Vec3& other) { return !(norm(place - other) >= min_distance_); };
      bool free = std::none_of(added.begin(), added.end(), is_near);
      for (std::uint32_t i = 0; free && i < stays.size(); ++i) free = !stays[i] || !is_near(now.place(i));
      if (free) return place;
    }
    return {};
  }

  /// Springs from the newest mass to random different ones of `partners`, whose order changes.
  void join(const Body& body, std::vector<std::uint32_t>& partners, Edits& edits, Rng& rng) const {
    const auto newest = static_cast<std::uint32_t>(body.masses.size() + edits.new_masses.size() - 1);
    const std::int32_t own = edits.new_masses.back().material;
    const auto count = static_cast<std::uint32_t>(partners.size());
    for (std::uint32_t i = 0; i < std::min<std::int64_t>(count, springs_); ++i) {
      std::swap(partners[i], partners[i + rng.below(count - i)]);
      const std::int32_t others = body.masses[partners[i]].material;
      const Material material = own == no_material || others == no_material
                                    ? random_spring_material(body, rng)
                                    : mean(body.materials[own], body.materials[others]);
      edits.new_springs.push_back({partners[i], newest, material, {}});
    }
  }

  static Material random_spring_material(const Body& body, Rng& rng) {
    return body.materials[body.springs[rng.below(static_cast<std::uint32_t>(body.springs.size()))].material];
  }

  static bool is_air(const Body& body, std::uint32_t mass) {
    const std::int32_t material = body.masses[mass].material;
    return material != no_material && !(body.materials[material].stiffness > 0);
  }

  template <class Predicate>
  static std::vector<std::uint32_t> indices_where(const Body& body, Predicate predicate) {
    std::vector<std::uint32_t> indices;
    for (std::uint32_t i = 0; i < body.masses.size(); ++i)
      if (predicate(i)) indices.push_back(i);
    return indices;
  }

  std::int64_t threshold_ = 20;
  std::int64_t limit_ = 10;
  std::int64_t springs_ = 25;
  double min_distance_ = 0.02;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<MassTurnover>("mass-turnover",
                                                     "Masses with few springs go, and new ones come at random places "
                                                     "(paper, section IV-D3)."))
