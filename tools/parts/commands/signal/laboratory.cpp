#include "signal/laboratory.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/genome_sections.hpp"
#include "life/measurement/combining.hpp"

namespace evodevo {
namespace {

constexpr std::size_t most_at_once = 1024;  ///< bodies in memory, enough to keep a GPU busy
constexpr double failed = std::numeric_limits<double>::quiet_NaN();

/// Whether two robots are born alike. Those that cannot be born are not.
bool are_born_alike(const BuiltBody& one, const BuiltBody& other) {
  if (!one.failure.empty() || !other.failure.empty() || one.mass_memory != other.mass_memory) return false;
  const Body &a = one.body, &b = other.body;
  return std::ranges::equal(a.masses, b.masses,
                            [](const Mass& p, const Mass& q) {
                              return p.rest == q.rest && p.mass == q.mass && p.material == q.material &&
                                     p.air_contacts == q.air_contacts;
                            }) &&
         std::ranges::equal(a.springs, b.springs,
                            [](const Spring& p, const Spring& q) {
                              return p.a == q.a && p.b == q.b && p.rest_length == q.rest_length &&
                                     p.material == q.material && p.stiffness_factor == q.stiffness_factor;
                            }) &&
         a.materials == b.materials && one.spring_memory == other.spring_memory;
}

/// Returns at most `most_at_once` of the items from number `begin` on.
template <class T>
std::span<const T> batch(const std::vector<T>& items, std::size_t begin) {
  return std::span(items).subspan(begin, std::min(most_at_once, items.size() - begin));
}

}  // namespace

Scores scores_in(const Lives& lives) {
  Scores all;
  for (const auto& of_individual : lives) {
    std::vector<double>& own = all.emplace_back();
    for (const std::vector<double>& life : of_individual) own.push_back(life.empty() ? failed : life.front());
  }
  return all;
}

Laboratory::Laboratory(const Experiment& experiment, Simulator& simulator)
    : experiment_(experiment),
      evaluation_(experiment, simulator, conditions_to_come(experiment)),
      workers_(simulator.workers()) {}

std::size_t Laboratory::lives_at_once() const { return static_cast<std::size_t>(experiment_.lives); }

std::size_t Laboratory::lives() const {
  constexpr std::size_t least_lives = 4, least_combinations = 2;
  const std::size_t combinations = (least_lives + lives_at_once() - 1) / lives_at_once();
  return std::max(least_combinations, combinations) * lives_at_once();
}

Lives Laboratory::first_lives_of(const std::vector<Individual>& individuals, std::size_t count, bool redrawn) const {
  return lives_of(individuals, std::vector<std::size_t>(individuals.size(), 0), count, redrawn);
}

Lives Laboratory::lives_of(const std::vector<Individual>& individuals, const std::vector<std::size_t>& first,
                           std::size_t count, bool redrawn) const {
  std::vector<Newborn> newborns;
  for (std::size_t i = 0; i < individuals.size(); ++i)
    for (std::size_t life = first[i]; life < first[i] + count; ++life) {
      Newborn& newborn = newborns.emplace_back(newborn_of(individuals[i]));
      newborn.life = unseen_life::studied + static_cast<std::uint32_t>(life);
      newborn.lives = 1;
      newborn.redrawn = redrawn;
    }
  Lives lives(individuals.size());
  std::size_t next = 0;
  for (std::size_t begin = 0; begin < newborns.size(); begin += most_at_once)
    for (Result& result : evaluation_.evaluate(batch(newborns, begin), [](double) {}))
      lives[next++ / count].push_back(std::move(result.objectives));
  return lives;
}

Scores Laboratory::combined_scores(const Scores& of_lives) const {
  const auto lives = static_cast<std::ptrdiff_t>(lives_at_once());
  Scores all;
  for (const std::vector<double>& of_individual : of_lives) {
    std::vector<double>& own = all.emplace_back();
    for (auto next = of_individual.begin(); next != of_individual.end(); next += lives) {
      const std::vector<double> some(next, next + lives);
      const bool is_whole = std::ranges::none_of(some, [](double score) { return std::isnan(score); });
      own.push_back(is_whole ? combined(some, experiment_.over_lives.front(), experiment_.objectives.front().maximise)
                             : failed);
    }
  }
  return all;
}

bool Laboratory::develop_alike(const Genome& a, const Genome& b) const {
  return std::ranges::all_of(experiment_.devo, [&](const Scheduled& devo) {
    if (!devo.own_section) return true;
    const auto own = [&](const Genome& genome) {
      return part_of(genome, experiment_.layout, {*devo.own_section}, experiment_.own_layouts.at(*devo.own_section));
    };
    return own(a) == own(b);
  });
}

std::vector<MeasuredChild> Laboratory::children_of_couples(const std::vector<Individual>& robots,
                                                           std::span<const Couple> couples) const {
  const auto highest = std::ranges::max_element(robots, {}, &Individual::id);
  const std::uint32_t born = std::ranges::max_element(robots, {}, &Individual::born)->born + 1;
  const std::vector<Individual> born_now = children_of(experiment_, robots, couples, born, highest->id + 1, &workers_);
  std::map<std::uint32_t, std::size_t> index;
  for (std::size_t i = 0; i < robots.size(); ++i) index[robots[i].id] = i;
  std::vector<std::size_t> first;  // life of each child
  for (std::size_t i = 0; i < couples.size(); ++i)
    first.push_back(i > 0 && couples[i].parent == couples[i - 1].parent ? first.back() + lives_at_once() : lives());
  const Scores scores = combined_scores(scores_in(lives_of(born_now, first, lives_at_once(), false)));
  std::vector<MeasuredChild> children;
  for (std::size_t i = 0; i < born_now.size(); ++i) {
    MeasuredChild& child = children.emplace_back();
    child.family = couples[i].parent;
    for (const std::uint32_t parent : born_now[i].parents) child.parents.push_back(index.at(parent));
    child.made_by = born_now[i].made_by;
    child.score = scores[i].front();
  }
  for (std::size_t begin = 0; begin < born_now.size(); begin += most_at_once) {
    std::vector<Newborn> parents, own;
    for (const Individual& child : batch(born_now, begin)) {
      parents.push_back(newborn_of(robots[children[begin + own.size()].family]));
      own.push_back(newborn_of(child));
    }
    const std::vector<BuiltBody> bodies = evaluation_.birth.build(own), of_parents = evaluation_.birth.build(parents);
    for (std::size_t i = 0; i < own.size(); ++i)
      children[begin + i].is_equal =
          are_born_alike(bodies[i], of_parents[i]) && develop_alike(*own[i].genome, *parents[i].genome);
  }
  return children;
}

}  // namespace evodevo
