// "Remove a chunk of the least stress springs and introduce as many new springs randomly" (paper, section IV-D2).
#include <set>
#include <tuple>

#include "evodevo/plugin.hpp"

namespace {

using evodevo::Body;
using evodevo::Edits;
using evodevo::Material;
using evodevo::Moment;
using evodevo::no_material;
using evodevo::Rng;

/// The partners of every mass, in one block of memory.
class Partners {
 public:
  explicit Partners(const Body& body) : first_(body.masses.size() + 1), partners_(body.springs.size()) {
    for (const auto& spring : body.springs) ++first_[std::min(spring.a, spring.b) + 1];
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    auto next = first_;
    for (const auto& spring : body.springs)
      partners_[next[std::min(spring.a, spring.b)]++] = std::max(spring.a, spring.b);
  }

  bool joined(std::uint32_t a, std::uint32_t b) const {
    const auto begin = partners_.begin() + first_[std::min(a, b)], end = partners_.begin() + first_[std::min(a, b) + 1];
    return std::find(begin, end, std::max(a, b)) != end;
  }

 private:
  std::vector<std::uint32_t> first_;  ///< where a mass's partners of higher index begin
  std::vector<std::uint32_t> partners_;
};

/// The `count` least stressed springs, least first, ties in random order. A stress that is not a number counts as the
/// greatest.
std::vector<std::uint32_t> least_stressed(std::span<const double> stress, std::size_t count, Rng& rng) {
  std::vector<double> comparable(stress.begin(), stress.end());
  for (double& value : comparable)
    if (std::isnan(value)) value = std::numeric_limits<double>::infinity();
  std::vector<double> ordered = comparable;
  const auto last = ordered.begin() + static_cast<std::ptrdiff_t>(count) - 1;
  std::nth_element(ordered.begin(), last, ordered.end());
  using Ranked = std::tuple<double, std::uint32_t, std::uint32_t>;
  std::vector<Ranked> ranked;
  for (std::uint32_t s = 0; s < comparable.size(); ++s)
    if (comparable[s] <= *last) ranked.emplace_back(comparable[s], rng(), s);
  std::sort(ranked.begin(), ranked.end());
  std::vector<std::uint32_t> springs;
  for (std::size_t i = 0; i < count; ++i) springs.push_back(std::get<2>(ranked[i]));
  return springs;
}

/// The number of springs stays: a spring goes only where another can come, so a body in which all masses are joined
/// stays as it is, and one of fewer springs than `springs` exchanges what it has. New springs come between two masses
/// that were not joined when the cycle ended, that are not in one place, and whose spring is not air. They are born
/// without force.
class SpringTurnover final : public evodevo::Devo {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.integer(springs_, "springs", {1, 1'000'000, "1"}, "Least stressed springs that go, and springs that come.");
  }

  void develop(const Moment& now, Edits& edits, Rng& rng) const override {
    const Body& body = now.body;
    const std::size_t count = std::min(body.springs.size(), static_cast<std::size_t>(springs_));
    if (count == 0 || body.masses.size() < 2) return;
    const auto leaving = least_stressed(now.stress, count, rng);
    const Partners partners(body);
    std::set<std::pair<std::uint32_t, std::uint32_t>> taken;
    // enough to fill a body that is nearly complete; a complete one ends here
    for (std::size_t attempts = attempts_per_spring * count; attempts > 0 && taken.size() < count; --attempts) {
      const auto [a, b] = random_pair(static_cast<std::uint32_t>(body.masses.size()), rng);
      if (partners.joined(a, b) || taken.contains({a, b}) || !(norm(now.place(b) - now.place(a)) > 0)) continue;
      const std::uint32_t leaves = leaving[taken.size()];
      const Material material = material_between(body, a, b, leaves);
      if (!(material.stiffness > 0)) continue;
      taken.insert({a, b});
      edits.removed_springs.push_back(leaves);
      edits.new_springs.push_back({a, b, material, {}});
    }
  }

 private:
  static constexpr std::size_t attempts_per_spring = 100;

  static std::pair<std::uint32_t, std::uint32_t> random_pair(std::uint32_t masses, Rng& rng) {
    const std::uint32_t a = rng.below(masses);
    std::uint32_t b = rng.below(masses - 1);
    if (b >= a) ++b;
    return std::minmax(a, b);
  }

  /// The mean of the two masses' materials; where masses have none, that of the spring that goes.
  static Material material_between(const Body& body, std::uint32_t a, std::uint32_t b, std::uint32_t leaves) {
    const std::int32_t first = body.masses[a].material, second = body.masses[b].material;
    if (first == no_material || second == no_material) return body.materials[body.springs[leaves].material];
    return mean(body.materials[first], body.materials[second]);
  }

  std::int64_t springs_ = 125;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<SpringTurnover>("spring-turnover",
                                                       "The least stressed springs go and as many come between random "
                                                       "masses (paper, section IV-D2)."))
