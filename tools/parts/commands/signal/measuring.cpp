#include "signal/measuring.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/input_error.hpp"
#include "base/philox.hpp"
#include "life/measurement/combining.hpp"
#include "signal/laboratory.hpp"

namespace evodevo {
namespace {

constexpr std::size_t lives_with_new_draws = 4;

bool is_whole(const std::vector<double>& scores) {
  return std::ranges::none_of(scores, [](double score) { return std::isnan(score); });
}

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

/// Families of some children.
struct Families {
  std::vector<Family> families;
  std::vector<std::size_t> robots;  ///< of each family
  std::size_t children = 0;
};

/// Returns the families of those children that `made_by` names as their makers, or of all if it is empty. Children of
/// one robot follow each other. On the scale of values, families and children without a fitness are left out.
Families families_of(const Scaled& scores, const std::vector<MeasuredChild>& children, const std::string& made_by) {
  Families all;
  for (std::size_t i = 0; i < children.size();) {
    const std::size_t robot = children[i].family;
    Family family{std::vector<double>(scores.parents[robot].size()), 0, 0};
    for (; i < children.size() && children[i].family == robot; ++i) {
      const MeasuredChild& child = children[i];
      if ((!made_by.empty() && child.made_by != made_by) || std::isnan(scores.children[i])) continue;
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

/// `has_repeatability`: whether what repeats in the parents' scores could be inherited.
void add_heritability(const Scaled& scores, const std::vector<MeasuredChild>& children, bool has_repeatability,
                      Findings& findings) {
  const Families all = families_of(scores, children, "");
  findings.add("heritability", "all children", scores.scale, heritability(all.families), all.children);
  if (has_repeatability)
    findings.add("heritability / repeatability", "all children", scores.scale, corrected(all, scores.parents),
                 all.children);
  std::set<std::string> operators;
  for (const MeasuredChild& child : children) operators.insert(child.made_by);
  if (operators.size() < 2) return;
  for (const std::string& made_by : operators)
    if (const Families some = families_of(scores, children, made_by); some.families.size() >= least_robots)
      findings.add("heritability", made_by, scores.scale, heritability(some.families), some.children);
}

/// Returns the median of scores, those that failed being worse than all others; nothing if the median failed.
std::optional<Estimate> median_with_failures(std::vector<double> scores, bool maximise) {
  const double worst = (maximise ? -1 : 1) * std::numeric_limits<double>::infinity();
  for (double& score : scores)
    if (std::isnan(score)) score = worst;
  return median_of(scores);
}

/// Draws a mate for each robot, another one if possible, and returns each couple so often.
std::vector<Couple> couples_at_random(std::size_t robots, Rng& rng) {
  std::vector<Couple> couples;
  const auto count = static_cast<std::uint32_t>(robots);
  for (std::uint32_t robot = 0; robot < count; ++robot) {
    const std::uint32_t mate = (robot + 1 + rng.below(std::max(1u, count - 1))) % count;
    couples.insert(couples.end(), children_of_each, Couple{robot, mate});
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
    if (std::ranges::all_of(scores[i], [](double score) { return std::isnan(score); })) continue;
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

/// Whether lives with draws of development of their own differ in that from the lives that the experiment gives.
bool draws_may_differ(const Experiment& experiment) {
  return experiment.develops_by_operators() && experiment.development.draws_between_lives == DrawsBetweenLives::same;
}

void measure(const Laboratory& laboratory, const Experiment& experiment, const Group& group,
             const std::string& population, Rng& rng, Signal& signal) {
  Findings findings(signal, population);
  const bool maximise = experiment.objectives.front().maximise;
  const Scores combined = laboratory.combined_scores(group.lives);
  findings.add_repeatability("one life", group.lives, maximise);
  if (experiment.lives > 1) findings.add_repeatability("all lives", combined, maximise);
  if (draws_may_differ(experiment))
    findings.add_repeatability(
        "new draws", scores_in(laboratory.first_lives_of(group.robots, lives_with_new_draws, true)), maximise);
  std::vector<double> scores;
  for (const auto& of_robot : combined) scores.insert(scores.end(), of_robot.begin(), of_robot.end());
  findings.add("score", "parents", "value", median_with_failures(scores, maximise), group.robots.size());
  if (experiment.makes_children()) return;

  const std::vector<MeasuredChild> children =
      laboratory.children_of_couples(group.robots, couples_at_random(group.robots.size(), rng));
  std::vector<double> values;
  double equal = 0;
  for (const MeasuredChild& child : children) {
    values.push_back(child.score);
    equal += child.is_equal;
  }
  // then robots repeat draws of their own, which no child inherits
  const bool draws_by_individual =
      experiment.develops_by_operators() && experiment.development.draws == DrawsBy::individual;
  const std::vector<double> ranks = ranked({values}, maximise).front();
  for (const Scaled& scaled : {Scaled{"rank", ranked(combined, maximise), ranks}, Scaled{"value", combined, values}})
    add_heritability(scaled, children, !draws_by_individual, findings);
  findings.add("equal bodies", "all children", "share", Estimate{equal / static_cast<double>(children.size()), {}, {}},
               children.size());
  findings.add("score", "children", "value", median_with_failures(values, maximise), children.size());
  signal.families.emplace_back(population, families_of({"value", combined, values}, children, "").families);
}

void measure_champion(const Laboratory& laboratory, const Experiment& experiment, const ArchivedIndividual& champion,
                      std::vector<Individual> others, Rng& rng, Signal& signal) {
  Findings findings(signal, "champion");
  const bool maximise = experiment.objectives.front().maximise;
  const auto add = [&](const char* of, const std::vector<double>& scores) {
    const auto failures = static_cast<double>(std::ranges::count_if(scores, [](double s) { return std::isnan(s); }));
    findings.add("failures", of, "share", Estimate{failures / static_cast<double>(scores.size()), {}, {}},
                 scores.size());
    findings.add("score", of, "value", median_with_failures(scores, maximise), scores.size());
  };
  const auto lives_to_come = [&](bool redrawn) {
    const std::size_t lives = measurements_of_champion * laboratory.lives_at_once();
    return laboratory.combined_scores(scores_in(laboratory.first_lives_of({champion}, lives, redrawn))).front();
  };
  findings.add("score", "record", "value", Estimate{champion.result.objectives.front(), {}, {}}, champion.lives);
  add("lives to come", lives_to_come(false));
  if (draws_may_differ(experiment)) add("new draws", lives_to_come(true));
  if (experiment.makes_children()) return;
  std::erase_if(others, [&](const Individual& other) { return other.id == champion.id; });
  others.push_back(champion);
  const auto self = static_cast<std::uint32_t>(others.size() - 1);
  std::vector<Couple> couples;
  for (std::size_t i = 0; i < children_of_champion; ++i) couples.push_back({self, self == 0 ? 0 : rng.below(self)});
  std::vector<double> scores;
  for (const MeasuredChild& child : laboratory.children_of_couples(others, couples)) scores.push_back(child.score);
  add("children", scores);
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
  const auto too_few = [](const Group& group, std::size_t of, const std::string& what) {
    return "only " + std::to_string(group.robots.size()) + " of " + std::to_string(of) + " " + what +
           " have a fitness, and " + std::to_string(least_robots) + " are needed";
  };
  if (random.robots.size() >= least_robots) {
    measure(laboratory, experiment, random, "random", rng, signal);
  } else {
    const std::string obstacle = too_few(random, measured.robots, "random robots");
    if (!measured.champion) throw InputError(obstacle + "; give more with --robots, or let more of them live");
    signal.notes.push_back("random robots were not measured: " + obstacle);
  }
  if (experiment.makes_children())
    signal.notes.push_back("what children inherit was not measured: " + experiment.child_maker +
                           " makes them of the whole population");
  if (!measured.champion) return signal;
  const std::vector<Individual> last = drawn_from(measured.last, measured.robots, rng);
  told(std::to_string(last.size()) + " robots of the last population");
  const Group group = group_of(laboratory, last, experiment);
  if (group.robots.size() >= least_robots)
    measure(laboratory, experiment, group, "last", rng, signal);
  else
    signal.notes.push_back("the last population was not measured: " + too_few(group, last.size(), "of its robots"));
  told("the best robot");
  measure_champion(laboratory, experiment, *measured.champion, last, rng, signal);
  return signal;
}

}  // namespace evodevo
