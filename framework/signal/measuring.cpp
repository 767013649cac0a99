#include "signal/measuring.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "base/input_error.hpp"
#include "base/philox.hpp"
#include "evolution/breeding.hpp"
#include "life/measurement/combining.hpp"

namespace evodevo {
namespace {

constexpr std::size_t lives_with_new_draws = 4;
constexpr double failed = std::numeric_limits<double>::quiet_NaN();

/// Returns the scores of each genome in several measurements, combined from `lives` lives each. A combination with a
/// life that failed failed.
Scores combinations(const Scores& lives_of_genomes, std::size_t lives, Over over, bool maximise) {
  Scores all;
  for (const std::vector<double>& of_lives : lives_of_genomes) {
    std::vector<double>& own = all.emplace_back();
    for (auto next = of_lives.begin(); next != of_lives.end(); next += static_cast<std::ptrdiff_t>(lives)) {
      const std::vector<double> some(next, next + static_cast<std::ptrdiff_t>(lives));
      own.push_back(std::ranges::any_of(some, [](double s) { return std::isnan(s); }) ? failed
                                                                                      : combined(some, over, maximise));
    }
  }
  return all;
}

bool is_whole(const std::vector<double>& scores) {
  return std::ranges::none_of(scores, [](double score) { return std::isnan(score); });
}

bool are_equal(const Body& a, const Body& b) {
  return std::ranges::equal(a.masses, b.masses,
                            [](const Mass& p, const Mass& q) {
                              return p.rest == q.rest && p.mass == q.mass && p.material == q.material &&
                                     p.air_contacts == q.air_contacts;
                            }) &&
         std::ranges::equal(a.springs, b.springs,
                            [](const Spring& p, const Spring& q) {
                              return p.a == q.a && p.b == q.b && p.rest_length == q.rest_length &&
                                     p.material == q.material && p.growth == q.growth &&
                                     p.stiffness_factor == q.stiffness_factor && p.phase_growth == q.phase_growth;
                            }) &&
         a.materials == b.materials;
}

/// The objectives of each individual in each of several lives; empty for those in which it failed.
using Lives = std::vector<std::vector<std::vector<double>>>;

/// Returns the scores in the first objective.
Scores scores_in(const Lives& lives) {
  Scores all;
  for (const auto& of_individual : lives) {
    std::vector<double>& own = all.emplace_back();
    for (const std::vector<double>& life : of_individual) own.push_back(life.empty() ? failed : life.front());
  }
  return all;
}

/// A child, and the indices of its parents among those measured.
struct Offspring {
  std::size_t family = 0;
  std::vector<std::size_t> parents;
  std::string made_by;
  bool has_equal_body = false;
  double score = failed;
};

/// Measures robots of one experiment, and their children.
class Laboratory {
 public:
  Laboratory(const Experiment& experiment, Simulator& simulator)
      : experiment_(experiment),
        evaluation_(experiment, simulator, conditions_to_come(experiment)),
        workers_(simulator.workers()) {}

  /// The number of lives in which robots are measured: at least four, and at least two combinations.
  std::size_t lives() const { return combinations_of_each() * lives_at_once(); }
  std::size_t lives_at_once() const { return static_cast<std::size_t>(experiment_.lives); }
  Over over() const { return experiment_.over_lives.front(); }
  bool maximise() const { return experiment_.objectives.front().maximise; }

  /// Lets individuals live `count` times each: individual i in the unseen lives from number `first(i)` on.
  template <class First>
  Lives lives_of(const std::vector<Individual>& individuals, const First& first, std::size_t count,
                 bool redrawn = false) const {
    std::vector<Newborn> newborns;
    for (std::size_t i = 0; i < individuals.size(); ++i)
      for (std::size_t life = 0; life < count; ++life) {
        Newborn& newborn = newborns.emplace_back(newborn_of(individuals[i]));
        newborn.life = unseen_life::studied + static_cast<std::uint32_t>(first(i) + life);
        newborn.lives = 1;
        newborn.redrawn = redrawn;
      }
    Lives lives(individuals.size());
    std::size_t next = 0;
    for (Result& result : evaluation_.evaluate(newborns, [](double) {}))
      lives[next++ / count].push_back(std::move(result.objectives));
    return lives;
  }
  Lives first_lives_of(const std::vector<Individual>& individuals, std::size_t count, bool redrawn = false) const {
    return lives_of(
        individuals, [](std::size_t) { return std::size_t{0}; }, count, redrawn);
  }

  Scores combined_scores(const Scores& of_lives) const {
    return combinations(of_lives, lives_at_once(), over(), maximise());
  }

  /// Returns children of couples of measured robots, with their scores in lives in which no parent was measured.
  /// Children of one couple, which follow each other, live in lives of different numbers, since luck is common to those
  /// of one number.
  std::vector<Offspring> children_of_couples(const std::vector<Individual>& robots, const Couples& couples) const {
    const auto highest = std::ranges::max_element(robots, {}, &Individual::id);
    const std::uint32_t born = std::ranges::max_element(robots, {}, &Individual::born)->born + 1;
    const std::vector<Individual> born_now =
        children_of(experiment_, robots, couples, born, highest->id + 1, &workers_);
    std::map<std::uint32_t, std::size_t> index;
    for (std::size_t i = 0; i < robots.size(); ++i) index[robots[i].id] = i;
    const std::vector<BuiltBody> bodies = bodies_of(robots), of_children = bodies_of(born_now);
    std::vector<std::size_t> first;  // life of each child
    for (std::size_t i = 0; i < couples.size(); ++i)
      first.push_back(i > 0 && couples[i].first == couples[i - 1].first ? first.back() + lives_at_once() : lives());
    const Scores scores = combined_scores(scores_in(lives_of(
        born_now, [&](std::size_t i) { return first[i]; }, lives_at_once())));
    std::vector<Offspring> children;
    for (std::size_t i = 0; i < born_now.size(); ++i) {
      Offspring& child = children.emplace_back();
      child.family = couples[i].first;
      for (const std::uint32_t parent : born_now[i].parents) child.parents.push_back(index.at(parent));
      child.made_by = born_now[i].made_by;
      child.has_equal_body = are_equal(of_children[i].body, bodies[child.family].body);
      child.score = scores[i].front();
    }
    return children;
  }

 private:
  std::size_t combinations_of_each() const { return std::max<std::size_t>(2, (3 + lives_at_once()) / lives_at_once()); }

  std::vector<BuiltBody> bodies_of(const std::vector<Individual>& individuals) const {
    std::vector<Newborn> newborns;
    for (const Individual& individual : individuals) newborns.push_back(newborn_of(individual));
    return evaluation_.birth.build(newborns);
  }

  const Experiment& experiment_;
  const Evaluation evaluation_;
  Workers& workers_;
};

/// Collects the numbers of one population.
class Findings {
 public:
  Findings(Signal& signal, std::string population) : signal_(signal), population_(std::move(population)) {}

  void add(const char* quantity, const std::string& of, const char* scale, const std::optional<Estimate>& estimate,
           std::size_t count) {
    if (estimate)
      signal_.numbers.push_back({population_, quantity, of, scale, estimate->value, estimate->low, estimate->high,
                                 static_cast<std::int64_t>(count)});
  }

  void add_repeatability(const std::string& of, const Scores& scores, bool maximise) {
    add("repeatability", of, "rank", repeatability(ranked(scores, maximise)), scores.size());
    Scores whole;
    std::ranges::copy_if(scores, std::back_inserter(whole), is_whole);
    add("repeatability", of, "value", repeatability(whole), whole.size());
  }

 private:
  Signal& signal_;
  std::string population_;
};

/// Scores of measured robots and their children on one scale.
struct Scaled {
  const char* scale;
  Scores parents;                ///< in each combination of lives
  std::vector<double> children;  ///< in the order of the children
};

/// Returns the families of those children that an operator made, or of all if it is empty. On the scale of values,
/// families and children without a fitness are left out.
struct Families {
  std::vector<Family> families;
  std::vector<std::size_t> robots;  ///< of each family
  std::size_t children = 0;
};

Families families_of(const Scaled& scores, const std::vector<Offspring>& children, const std::string& made_by) {
  Families all;
  for (std::size_t robot = 0; robot < scores.parents.size(); ++robot) {
    Family family{std::vector<double>(scores.parents[robot].size()), 0, 0};
    for (std::size_t i = 0; i < children.size(); ++i) {
      const Offspring& child = children[i];
      if (child.family != robot || (!made_by.empty() && child.made_by != made_by) || std::isnan(scores.children[i]))
        continue;
      std::vector<double> parents(family.parents.size());
      for (const std::size_t parent : child.parents)
        for (std::size_t j = 0; j < parents.size(); ++j)
          parents[j] += scores.parents[parent][j] / static_cast<double>(child.parents.size());
      if (!is_whole(parents)) continue;
      for (std::size_t j = 0; j < parents.size(); ++j) family.parents[j] += parents[j];
      family.children += scores.children[i];
      family.weight += 1;
    }
    if (family.weight == 0) continue;
    for (double& score : family.parents) score /= family.weight;
    family.children /= family.weight;
    all.children += static_cast<std::size_t>(family.weight);
    all.families.push_back(std::move(family));
    all.robots.push_back(robot);
  }
  return all;
}

/// Returns the heritability divided by the repeatability of the parents' scores, both of the same families.
std::optional<Estimate> corrected(const Families& all, const Scores& parents) {
  constexpr double least = 0.05;  // a quotient by less says nothing
  Scores of_families;
  for (const std::size_t robot : all.robots) of_families.push_back(parents[robot]);
  if (!std::ranges::all_of(of_families, is_whole)) return std::nullopt;
  return bootstrapped(all.families.size(), [&](auto which) -> std::optional<double> {
    const auto slope = regression(all.families, which), repeated = intraclass_correlation(of_families, which);
    if (!slope || !repeated || *repeated < least) return std::nullopt;
    return *slope / *repeated;
  });
}

void add_heritability(const Scaled& scores, const std::vector<Offspring>& children, Findings& findings) {
  const Families all = families_of(scores, children, "");
  findings.add("heritability", "all children", scores.scale, heritability(all.families), all.children);
  findings.add("heritability / repeatability", "all children", scores.scale, corrected(all, scores.parents),
               all.children);
  std::set<std::string> operators;
  for (const Offspring& child : children) operators.insert(child.made_by);
  if (operators.size() < 2) return;
  for (const std::string& made_by : operators)
    if (const Families some = families_of(scores, children, made_by); some.families.size() >= least_robots)
      findings.add("heritability", made_by, scores.scale, heritability(some.families), some.children);
}

std::vector<double> finite(std::vector<double> values) {
  std::erase_if(values, [](double value) { return std::isnan(value); });
  return values;
}

/// Draws a mate for each robot, another one if possible, and returns each couple so often.
Couples couples_at_random(std::size_t robots, Rng& rng) {
  Couples couples;
  const auto count = static_cast<std::uint32_t>(robots);
  for (std::uint32_t robot = 0; robot < count; ++robot) {
    const std::uint32_t mate = (robot + 1 + rng.below(std::max(1u, count - 1))) % count;
    couples.insert(couples.end(), children_of_each, {robot, mate});
  }
  return couples;
}

/// The robots of a population that have a fitness in some unseen life, and their scores in these.
struct Group {
  std::vector<Individual> robots;
  Scores lives;
};

/// Measures robots. Those that have a fitness in all of these lives get objectives, by which variation knows the better
/// of two parents.
Group group_of(const Laboratory& laboratory, std::vector<Individual> robots, const Experiment& experiment) {
  const Lives lives = laboratory.first_lives_of(robots, laboratory.lives());
  const Scores scores = scores_in(lives);
  Group group;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (finite(scores[i]).empty()) continue;
    Result& result = robots[i].result = {};
    if (is_whole(scores[i]))
      result.objectives = objectives_of(lives[i], experiment);
    else
      result.status = Status::invalid;
    group.robots.push_back(std::move(robots[i]));
    group.lives.push_back(scores[i]);
  }
  return group;
}

void measure(const Laboratory& laboratory, const Experiment& experiment, const Group& group,
             const std::string& population, Rng& rng, Signal& signal) {
  Findings findings(signal, population);
  const bool maximise = laboratory.maximise();
  const Scores combined = laboratory.combined_scores(group.lives);
  findings.add_repeatability("one life", group.lives, maximise);
  if (experiment.lives > 1) findings.add_repeatability("all lives", combined, maximise);
  if (experiment.develops_by_operators() && experiment.development.draws_between_lives == DrawsBetweenLives::same)
    findings.add_repeatability(
        "new draws", scores_in(laboratory.first_lives_of(group.robots, lives_with_new_draws, true)), maximise);
  std::vector<double> scores;
  for (const auto& of_robot : combined) scores.insert(scores.end(), of_robot.begin(), of_robot.end());
  findings.add("score", "parents", "value", median_of(finite(scores)), group.robots.size());
  if (experiment.makes_children()) return;

  const std::vector<Offspring> children =
      laboratory.children_of_couples(group.robots, couples_at_random(group.robots.size(), rng));
  std::vector<double> values;
  double equal = 0;
  for (const Offspring& child : children) {
    values.push_back(child.score);
    equal += child.has_equal_body;
  }
  const std::vector<double> ranks = ranked({values}, maximise).front();
  for (const Scaled& scaled : {Scaled{"rank", ranked(combined, maximise), ranks}, Scaled{"value", combined, values}})
    add_heritability(scaled, children, findings);
  findings.add("equal bodies", "all children", "share", Estimate{equal / static_cast<double>(children.size()), {}, {}},
               children.size());
  findings.add("score", "children", "value", median_of(finite(values)), children.size());
  const Families drawn = families_of({"value", combined, values}, children, "");
  for (const Family& family : drawn.families) {
    const double sum = std::accumulate(family.parents.begin(), family.parents.end(), 0.0);
    signal.families[population].push_back({sum / static_cast<double>(family.parents.size()), family.children});
  }
}

void measure_champion(const Laboratory& laboratory, const Experiment& experiment, const ArchivedIndividual& champion,
                      std::vector<Individual> others, Rng& rng, Signal& signal) {
  Findings findings(signal, "champion");
  const auto lives_to_come = [&](bool redrawn) {
    return finite(scores_in(laboratory.first_lives_of({champion}, lives_of_champion, redrawn)).front());
  };
  findings.add("score", "record", "value", Estimate{champion.result.objectives.front(), {}, {}}, champion.lives);
  const std::vector<double> same = lives_to_come(false);
  findings.add("score", "lives to come", "value", median_of(same), same.size());
  if (experiment.develops_by_operators()) {
    const std::vector<double> redrawn = lives_to_come(true);
    findings.add("score", "new draws", "value", median_of(redrawn), redrawn.size());
  }
  if (experiment.makes_children()) return;
  std::erase_if(others, [&](const Individual& other) { return other.id == champion.id; });
  others.push_back(champion);
  const auto self = static_cast<std::uint32_t>(others.size() - 1);
  Couples couples;
  for (std::size_t i = 0; i < children_of_champion; ++i) couples.emplace_back(self, self == 0 ? 0 : rng.below(self));
  std::vector<double> scores;
  for (const Offspring& child : laboratory.children_of_couples(others, couples)) scores.push_back(child.score);
  findings.add("score", "children", "value", median_of(finite(scores)), scores.size());
}

/// Returns at most `count` of the individuals with a fitness, drawn at random.
std::vector<Individual> drawn_from(std::vector<Individual> individuals, std::size_t count, Rng& rng) {
  std::erase_if(individuals, [](const Individual& one) { return one.result.status != Status::ok; });
  rng.shuffle(individuals);
  if (individuals.size() > count) individuals.resize(count);
  return individuals;
}

}  // namespace

Signal measure_signal(const Experiment& experiment, Simulator& simulator, const MeasuredRobots& measured,
                      const std::function<void(const std::string&)>& told) {
  const Laboratory laboratory(experiment, simulator);
  Rng rng(philox, {static_cast<std::uint64_t>(experiment.seed), 0, 0, rng_stream::signal});
  Signal signal;
  told(std::to_string(measured.robots) + " random robots");
  const Group random = group_of(laboratory, breed(experiment, {}, 0, 0, measured.robots), experiment);
  if (random.robots.size() < least_robots)
    throw InputError("only " + std::to_string(random.robots.size()) + " of " + std::to_string(measured.robots) +
                     " random robots have a fitness, and " + std::to_string(least_robots) +
                     " are needed; give more with --robots, or let more of them live");
  measure(laboratory, experiment, random, "random", rng, signal);
  if (!measured.champion) return signal;
  const std::vector<Individual> last = drawn_from(measured.last, measured.robots, rng);
  told(std::to_string(last.size()) + " robots of the last population");
  const Group group = group_of(laboratory, last, experiment);
  if (group.robots.size() >= least_robots) measure(laboratory, experiment, group, "last", rng, signal);
  told("the best robot");
  measure_champion(laboratory, experiment, *measured.champion, last, rng, signal);
  return signal;
}

}  // namespace evodevo
