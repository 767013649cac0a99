// Estimates of what repeats in scores and of what children inherit: on numbers whose answer is published or follows
// from how they are made, and on populations whose scores are a gene and noise.
#include "report/signal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/philox.hpp"
#include "signal/estimates.hpp"
#include "signal/measuring.hpp"
#include "support/lives.hpp"
#include "support/messages.hpp"
#include "support/planted.hpp"
#include "support/refusals.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using ::testing::DoubleNear, ::testing::ElementsAre, ::testing::HasSubstr, ::testing::Not;
using testing::planted, testing::naming, testing::small;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Genomes whose scores are normal with variance 1 between them, and measured with the given variance of noise.
Scores normal_scores(std::size_t genomes, std::size_t measurements, double noise, Rng& rng) {
  Scores scores;
  for (std::size_t i = 0; i < genomes; ++i) {
    const double own = rng.normal();
    std::vector<double>& measured = scores.emplace_back();
    for (std::size_t k = 0; k < measurements; ++k) measured.push_back(own + std::sqrt(noise) * rng.normal());
  }
  return scores;
}

TEST(Repeatability, IsThePublishedOneOfAPublishedTable) {
  // table 2 of Shrout and Fleiss (1979): ICC(1,1) = 0.17
  const Scores table = {{9, 2, 5, 8}, {6, 1, 3, 2}, {8, 4, 6, 8}, {7, 1, 2, 6}, {10, 5, 6, 9}, {6, 2, 4, 7}};
  const auto estimate = repeatability(table);
  ASSERT_TRUE(estimate);
  EXPECT_NEAR(estimate->value, 0.166, 0.0005);
  EXPECT_LT(*estimate->low, estimate->value);
  EXPECT_GT(*estimate->high, estimate->value);
}

TEST(Repeatability, IsMissingWhereNothingCanBeSaid) {
  for (const Scores& scores : {Scores{}, Scores{{1, 2}}, Scores{{1}, {2}, {3}}, Scores{{2, 2}, {2, 2}, {2, 2}},
                               Scores{{1, 2}, {3, nan}}, Scores{{0.1, 0.1, 0.1}, {0.1, 0.1, 0.1}}})
    EXPECT_FALSE(repeatability(scores)) << scores.size();
  const auto sure = repeatability({{1, 1}, {2, 2}, {3, 3}, {4, 4}, {5, 5}, {7, 7}});
  EXPECT_THAT(std::vector({sure->value, *sure->low, *sure->high}), ::testing::Each(DoubleNear(1, 1e-12)));
}

TEST(Repeatability, ItsIntervalHoldsTheTruthAboutAsOftenAsItSays) {
  Rng rng(philox, {.seed = 3});
  int held = 0, below = 0;
  constexpr int tables = 200;
  for (int i = 0; i < tables; ++i) {
    const auto estimate = repeatability(normal_scores(60, 4, 1.5, rng));
    held += *estimate->low <= 0.4 && 0.4 <= *estimate->high;
    below += estimate->value < 0.4;
  }
  EXPECT_GE(held, tables * 0.88);
  EXPECT_LT(held, tables);
  EXPECT_NEAR(below, tables / 2, 3 * std::sqrt(tables) / 2 + 0.05 * tables);
}

TEST(Ranks, AreSharedByEqualScoresAndFailuresComeLast) {
  const Scores scores = {{5, nan}, {1, 5}, {-2, nan}};
  EXPECT_THAT(ranked(scores, true), ElementsAre(ElementsAre(10.0 / 12, 2.0 / 12), ElementsAre(7.0 / 12, 10.0 / 12),
                                                ElementsAre(5.0 / 12, 2.0 / 12)));
  EXPECT_THAT(ranked(scores, false), ElementsAre(ElementsAre(6.0 / 12, 2.0 / 12), ElementsAre(9.0 / 12, 6.0 / 12),
                                                 ElementsAre(11.0 / 12, 2.0 / 12)));
}

TEST(Heritability, IsTheSlopeOfALineAndThatOfTheHeavierFamilies) {
  std::vector<Family> line;
  for (const double x : {0.0, 1.0, 2.0, 5.0, 7.5}) line.push_back({{x}, 3 - 0.25 * x, 4});
  const auto estimate = heritability(line);
  EXPECT_NEAR(estimate->value, -0.25, 1e-12);
  EXPECT_NEAR(*estimate->low, -0.25, 1e-12);
  EXPECT_NEAR(*estimate->high, -0.25, 1e-12);
  // points (0, 0), (1, 1) twice and (1, 4) once: the weighted mean at 1 is 2
  EXPECT_NEAR(heritability(std::vector<Family>{{{0}, 0, 3}, {{1}, 1, 2}, {{1}, 4, 1}})->value, 2, 1e-12);
  EXPECT_FALSE(heritability(std::vector<Family>{{{2, 2}, 1, 4}, {{2, 2}, 3, 4}}));
  EXPECT_FALSE(heritability({}));
}

TEST(Heritability, FallsWithTheNoiseOfOneMeasurementOfTheParents) {
  Rng rng(philox, {.seed = 4});
  std::vector<Family> families;
  for (const auto& parents : normal_scores(4000, 3, 1, rng)) families.push_back({parents, 0, 4});
  Rng again(philox, {.seed = 4});
  for (Family& family : families) {
    family.children = 0.6 * again.normal() + 0.3 * rng.normal();
    for (int k = 0; k < 3; ++k) again.normal();  // the noise of the parent's measurements
  }
  EXPECT_NEAR(heritability(families)->value, 0.6 / 2, 0.02) << "half of the variance is noise";
}

TEST(Medians, HaveIntervalsOverTheirValues) {
  EXPECT_EQ(median_of({3, 1, 10})->value, 3);
  EXPECT_EQ(median_of({3, 1, 10, 5})->value, 4);
  EXPECT_FALSE(median_of({}));
  EXPECT_FALSE(median_of({7})->low);
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(median_of({-infinity, 1, 2})->value, 1);
  EXPECT_FALSE(median_of({-infinity, -infinity, 2}));
  const auto estimate = median_of({1, 2, 3, 4, 5, 6, 7, 8, 9, 10});
  EXPECT_GE(*estimate->low, 2);
  EXPECT_LE(*estimate->high, 9);
}

Signal measured(const Experiment& experiment, std::size_t robots) {
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 2);
  return measure_signal(experiment, *simulator, {robots}, [](const std::string&) {});
}

SignalNumber found_in(const Signal& signal, const std::string& quantity, const std::string& of,
                      const std::string& scale) {
  for (const SignalNumber& one : signal.numbers)
    if (one.population == "random" && one.quantity == quantity && one.of == of && one.scale == scale) return one;
  ADD_FAILURE() << quantity << " of " << of << " on the scale " << scale << " is missing";
  return {.value = nan};
}

double number(const Signal& signal, const std::string& quantity, const std::string& of, const std::string& scale) {
  return found_in(signal, quantity, of, scale).value;
}

/// The score of a genome is the mean of 18 genes with 5 values each, and luck whose variance is 2/3 noise².
constexpr double variance_of_quality = 2.0 / 16 / 18;
constexpr double variance_of_luck(double noise) { return noise * noise * 2 / 3; }
const std::string no_crossover = "crossover.0.probability=0.0000001", all_mutate = "mutation.0.probability=1";

TEST(Signal, OfAGeneAndNoiseIsThatWhichFollowsFromTheirVariances) {
  constexpr double noise = 0.1;
  constexpr double r = variance_of_quality / (variance_of_quality + variance_of_luck(noise));
  // nine of the 18 genes become one of the four other values, whose correlation with the old one is -1/4
  constexpr double inherited = (9 - 9 * 0.25) / 18;
  const Signal found =
      measured(planted({no_crossover, all_mutate, "mutation.0.genes=9", "experiment.lives=3"}, noise), 300);
  EXPECT_NEAR(number(found, "repeatability", "one life", "value"), r, 0.08);
  EXPECT_NEAR(number(found, "repeatability", "all lives", "value"), 3 * r / (1 + 2 * r), 0.08);
  EXPECT_NEAR(number(found, "repeatability", "all lives", "rank"), 3 * r / (1 + 2 * r), 0.1);
  EXPECT_NEAR(number(found, "heritability", "all children", "value"), inherited * 3 * r / (1 + 2 * r), 0.08);
  EXPECT_NEAR(number(found, "heritability / repeatability", "all children", "value"), inherited, 0.1);
  EXPECT_NEAR(number(found, "heritability / repeatability", "all children", "rank"), inherited, 0.12);
  EXPECT_NEAR(number(found, "score", "parents", "value"), 0.5, 0.02);
  EXPECT_LT(number(found, "equal bodies", "all children", "share"), 0.1) << "as many as have the same sum of genes";
  EXPECT_GT(found.families.at(0).second.size(), 290u);
}

/// Draws all genes again, with which children are like anybody.
struct Forgetting final : Mutation {
  void mutate(Genome& genome, const VariationContext&, Rng& rng) const override {
    for (float& gene : genome.genes) gene = static_cast<float>(rng.below(5));
  }
};

TEST(Signal, OfChildrenIsToldByTheOperatorThatMadeThem) {
  Experiment experiment = planted({no_crossover, "mutation.0.probability=0.5"}, 0);
  experiment.mutations.push_back({std::make_unique<Forgetting>(), "forgetting", 0.5, experiment.mutations[0].sections,
                                  experiment.mutations[0].layout});
  const Signal found = measured(experiment, 250);
  EXPECT_NEAR(number(found, "heritability", "reset-weight", "value"), (17 - 0.25) / 18, 0.06);
  EXPECT_NEAR(number(found, "heritability", "forgetting", "value"), 0, 0.15);
  EXPECT_NEAR(number(found, "heritability", "reset-weight+forgetting", "value"), 0, 0.15);
  EXPECT_NEAR(number(found, "heritability", "all children", "value"), (17 - 0.25) / 18 / 3, 0.1);
  EXPECT_EQ(number(found, "repeatability", "one life", "value"), 1) << "without noise";
}

/// Leaves every genome as it is.
struct Idle final : Mutation {
  void mutate(Genome&, const VariationContext&, Rng&) const override {}
};

TEST(Signal, OfClonesIsWhatRepeats) {
  Experiment experiment = planted({no_crossover, all_mutate}, 0.1);
  experiment.mutations[0].op = std::make_unique<Idle>();
  const Signal found = measured(experiment, 150);
  EXPECT_EQ(number(found, "equal bodies", "all children", "share"), 1);
  EXPECT_NEAR(number(found, "heritability / repeatability", "all children", "value"), 1, 0.15);
  EXPECT_NEAR(number(found, "heritability", "all children", "value"),
              number(found, "repeatability", "one life", "value"), 0.12);
  EXPECT_THAT(sentences_on(found.numbers, experiment, experiment.objectives[0]),
              ::testing::Contains(HasSubstr("larger mutations")));
}

TEST(Signal, OfCrossedRobotsIsRegressedOnBothParents) {
  // each child has about half of the genes of either parent, so that it is the mid-parent in the mean
  const Signal found = measured(
      planted({"crossover.0.name=uniform", "crossover.0.probability=1", "mutation.0.probability=0.0000001"}, 0.1), 300);
  EXPECT_NEAR(number(found, "heritability / repeatability", "all children", "value"), 1, 0.15);
}

/// A fifth of the lives fail, whoever lives them.
TEST(Signal, OfRobotsThatFailInSomeLivesRanksThemAndLeavesTheirValuesOut) {
  Experiment experiment = planted({no_crossover, all_mutate});
  testing::score_by(experiment,
                    {{{.settle = 0, .window = 0.02}, {{"quality", "1"}}, [](const Observation& seen) {
                        const Body& body = *seen.body;
                        const double luck = (seen.box.high.x - seen.box.low.x - 1) / 0.1;
                        return std::vector{luck > 0.8 ? nan : body.materials[body.springs[0].material].phase};
                      }}});
  const Signal found = measured(experiment, 200);
  EXPECT_GT(found_in(found, "repeatability", "one life", "rank").count, 195);
  const SignalNumber whole = found_in(found, "repeatability", "one life", "value");
  EXPECT_NEAR(static_cast<double>(whole.count), 200 * std::pow(1 - 1.2 * 1.2 / 8, 4), 30) << "those with four lives";
  EXPECT_EQ(whole.value, 1) << "nothing but failures differs between their lives";
  EXPECT_LT(number(found, "repeatability", "one life", "rank"), 0.7);
  EXPECT_NEAR(number(found, "heritability", "all children", "value"), (17 - 0.25) / 18, 0.08);
  EXPECT_LT(number(found, "score", "parents", "value"), 0.5) << "a failure is worse than any score";
}

TEST(Signal, SaysHowManyLivesWouldHelp) {
  const Experiment experiment = planted({});
  const auto told = [&](double one, double children, double equal) {
    const std::vector<SignalNumber> numbers = {
        {"random", "repeatability", "one life", "rank", one, one - 0.1, one + 0.1, 60},
        {"random", "heritability", "all children", "rank", children, children - 0.1, children + 0.1, 240},
        {"random", "heritability / repeatability", "all children", "rank", children / one, children / one - 0.1,
         children / one + 0.1, 240},
        {"random", "equal bodies", "all children", "share", equal, {}, {}, 240}};
    std::string all;
    for (const std::string& sentence : sentences_on(numbers, experiment, experiment.objectives[0]))
      all += sentence + ' ';
    return all;
  };
  EXPECT_THAT(told(0.5, 0.4, 0), naming("50 %", "lives = 4", "0.8", "40 %"));
  EXPECT_THAT(told(0.4, 0.3, 0), naming("lives = 6"));
  EXPECT_THAT(told(0.1, 0.08, 0), naming("36 lives", "another measure"));
  EXPECT_THAT(told(1, 0.5, 0), naming("the same", "start_noise"));
  EXPECT_THAT(told(0.01, 0, 0), naming("No number of lives"));
  EXPECT_THAT(told(0.9, 0.1, 0), naming("Smaller mutations"));
  EXPECT_THAT(told(0.9, 0.1, 0), Not(naming("lives =")));
  EXPECT_THAT(told(0.9, 0.8, 0.7), naming("70 %", "larger mutations"));
  const auto last = [&](double at_first, double now) {
    return sentences_on({{"random", "repeatability", "one life", "rank", at_first, at_first - 0.1, at_first + 0.1, 60},
                         {"last", "repeatability", "one life", "rank", now, now - 0.1, now + 0.1, 60}},
                        experiment, experiment.objectives[0])
        .at(0);
  };
  EXPECT_THAT(last(0.8, 0.05), naming("0.80", "used up", "remeasure"));
  EXPECT_THAT(last(0.3, 0.25), Not(naming("used up"))) << "nor was there much";
  EXPECT_TRUE(sentences_on({}, experiment, experiment.objectives[0]).empty());
}

/// Returns what is said of the best robot. A score that is not given was not measured; one that is NaN has no median.
std::string said_of_champion(const std::vector<std::pair<std::string, double>>& scores, bool maximise = true) {
  Experiment experiment = planted({});
  experiment.objectives[0].maximise = maximise;
  std::vector<SignalNumber> numbers = {{"champion", "score", "record", "value", 4, {}, {}, 1}};
  for (const auto& [of, score] : scores) {
    numbers.push_back({"champion", "failures", of, "share", std::isnan(score) ? 0.5 : 0, {}, {}, 10});
    if (!std::isnan(score)) numbers.push_back({"champion", "score", of, "value", score, {}, {}, 10});
  }
  return sentences_on(numbers, experiment, experiment.objectives[0]).front();
}

TEST(Signal, OfTheBestRobotTellsWhatFailedAndWhatItsChildrenGet) {
  EXPECT_THAT(
      said_of_champion({{"lives to come", 3}, {"new draws", 2}, {"children", 1}}),
      naming("record 4", " is 3, 75 % of it;", "other draws of development is 2, 50 %", "children is 1, 25 % of it"));
  EXPECT_THAT(said_of_champion({{"lives to come", nan}, {"children", nan}}),
              naming("at least half of lives to come fail", "at least half of its children fail"));
  EXPECT_THAT(said_of_champion({{"lives to come", 3}}),
              Not(::testing::AnyOf(HasSubstr("draws"), HasSubstr("children"))));
  EXPECT_THAT(said_of_champion({{"lives to come", 3}, {"children", -1}}),
              AllOf(HasSubstr(" is 3, 75 %"), ::testing::ContainsRegex("children is -1[^%]*$")));
  EXPECT_THAT(said_of_champion({{"lives to come", 5}, {"children", 8}}, false), Not(naming("%"))) << "less is better";
}

TEST(Signal, AdvisesMoreRobotsOnlyWhereThereAreMore) {
  Experiment experiment = planted({});
  experiment.population = 20;
  const auto advice = [&](const std::string& population, std::int64_t robots) {
    const std::vector<SignalNumber> numbers = {
        {population, "repeatability", "one life", "rank", 0.9, 0.8, 0.95, robots},
        {population, "score", "parents", "value", 1, {}, {}, robots},
        {population, "heritability", "all children", "rank", 0.4, 0.1, 0.7, 80},
        {population, "equal bodies", "all children", "share", 0, {}, {}, 80}};
    return sentences_on(numbers, experiment, experiment.objectives[0]).back();
  };
  EXPECT_THAT(advice("random", 20), HasSubstr("--robots"));
  EXPECT_THAT(advice("last", 19), HasSubstr("--robots"));
  EXPECT_THAT(advice("last", 20), AllOf(HasSubstr("population"), Not(HasSubstr("--robots"))));
}

/// Scores are a gene and noise, and less is better in one of the two runs.
TEST(Signal, OfARunIsThatOfItsLastPopulationAndItsBestRobot) {
  for (const bool maximise : {true, false}) {
    constexpr double noise = 0.05;
    const auto make = [&](const std::vector<std::string>& values) {
      Experiment experiment = planted(values, noise);
      experiment.objectives[0].maximise = maximise;
      return experiment;
    };
    const std::vector<std::string> values = {no_crossover,
                                             all_mutate,
                                             "mutation.0.genes=9",
                                             "experiment.lives=2",
                                             "experiment.evaluations=400",
                                             "experiment.population=40"};
    const testing::FinishedRun run(make(values));
    const Experiment experiment = make(values);
    const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 2);
    const ArchivedIndividual best = run.archive.known_individual(run.archive.best(1).front());
    const auto measure = [&](std::vector<Individual> last) {
      return measure_signal(experiment, *simulator, {60, best, std::move(last)}, [](const std::string&) {});
    };
    const Signal found = measure(run.archive.population());
    const auto of = [&](const std::string& population, const std::string& quantity, const std::string& what) {
      for (const SignalNumber& one : found.numbers)
        if (one.population == population && one.quantity == quantity && one.of == what && one.scale != "rank")
          return one.value;
      ADD_FAILURE() << quantity << " of " << what << " is missing";
      return nan;
    };
    const double quality = testing::Planted::quality(best.genome);
    EXPECT_EQ(of("champion", "score", "record"), best.result.objectives[0]);
    EXPECT_NEAR(of("champion", "score", "lives to come"), quality, 0.03);
    EXPECT_EQ(of("champion", "failures", "lives to come"), 0);
    // half of the genes become one of the four others, with a correlation of -1/4
    EXPECT_NEAR(of("champion", "score", "children"), 0.5 + (quality - 0.5) * (9 - 9 * 0.25) / 18, 0.06);
    double mean = 0;
    for (const Individual& one : run.archive.population()) mean += testing::Planted::quality(one.genome) / 40;
    EXPECT_NEAR(of("last", "score", "parents"), mean, 0.04);
    EXPECT_GT((of("last", "score", "parents") - 0.5) * (maximise ? 1 : -1), 0.1) << "selection has moved it";
    EXPECT_TRUE(found.notes.empty());

    std::vector<Individual> few = run.archive.population();
    few.resize(7);
    const Signal without = measure(std::move(few));
    EXPECT_THAT(without.notes, ElementsAre(naming("last population", "7 of 7", "8")));
    EXPECT_TRUE(std::ranges::none_of(without.numbers, [](const auto& one) { return one.population == "last"; }));
    EXPECT_TRUE(std::ranges::any_of(without.numbers, [](const auto& one) { return one.population == "champion"; }));
  }
}

TEST(Signal, OfChildrenThatSelectionMakesIsNotHeritability) {
  const Experiment experiment = small({"encoding={name='neural', points=20, neighbours=6}", "mutation=[]",
                                       "crossover=[]", "selection.name=cma-es", "experiment.birth_noise=0.01"});
  const Signal found = measured(experiment, 12);
  EXPECT_THAT(found.notes, ElementsAre(naming("cma-es", "children")));
  EXPECT_TRUE(std::ranges::none_of(found.numbers, [](const auto& one) { return one.quantity == "heritability"; }));
  EXPECT_TRUE(std::ranges::any_of(found.numbers, [](const auto& one) { return one.quantity == "score"; }));
}

/// With draws of its own, a clone does not develop as its parent did, however small mutations are.
TEST(Signal, OfIndividualDrawsBlamesNoMutation) {
  Experiment experiment = small({"development.draws=individual", "experiment.birth_noise=0.01", all_mutate});
  experiment.mutations[0].op = std::make_unique<Idle>();
  const Signal found = measured(experiment, 12);
  EXPECT_TRUE(
      std::ranges::none_of(found.numbers, [](const auto& one) { return one.quantity.find('/') != std::string::npos; }));
}

TEST(Signal, OfARunIsKeptUntilItsPopulationChanges) {
  const testing::Scratch scratch;
  const auto folder = scratch / "run";
  {
    const Experiment experiment = planted({"experiment.evaluations=40"});
    const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 2);
    Archive begun = Archive::create(folder, experiment, simulator->device());
    evolve(experiment, *simulator, begun, false, Observer{});
  }
  Archive archive = Archive::annotate(folder);
  const std::vector<SignalNumber> numbers = {{"random", "repeatability", "one life", "rank", 0.5, 0.25, 0.75, 60},
                                             {"last", "equal bodies", "all children", "share", 0, {}, {}, 240}};
  const std::uint32_t last = archive.generations().back().generation;
  EXPECT_TRUE(archive.set_signal({{"older", "", "", "", 1, {}, {}, 1}, {"older", "", "", "", 2, {}, {}, 1}}, last));
  EXPECT_TRUE(archive.set_signal(numbers, last));
  EXPECT_FALSE(archive.set_signal({}, last - 1)) << "numbers of a population that lives no longer";
  const auto read = [&] { return Archive::read(folder).signal(); };
  ASSERT_EQ(read().size(), 2u);
  EXPECT_EQ(read()[0].population, "random");
  EXPECT_EQ(read()[0].high, 0.75);
  EXPECT_EQ(read()[1].scale, "share");
  EXPECT_EQ(read()[1].low, std::nullopt);
  EXPECT_EQ(read()[1].count, 240);
  {
    Archive resumed = Archive::resume(folder);
    FinishedGeneration next;
    next.summary = resumed.generations().back();
    ++next.summary.generation;
    resumed.commit(next);
  }
  EXPECT_TRUE(read().empty());
}

TEST(Signal, OfTooFewRobotsWithAFitnessIsRefused) {
  Experiment experiment = planted({});
  testing::score_by(
      experiment,
      {{{.settle = 0, .window = 0.02}, {{"nothing", "1"}}, [](const Observation&) { return std::vector{nan}; }}});
  EXPECT_THAT(testing::refusal<InputError>([&] { measured(experiment, 20); }), naming("0 of 20", "--robots"));
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
