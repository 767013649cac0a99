// Several lives of an individual: in what they differ, how their scores become one, and members that live again.
#include "support/lives.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "analysis/energy.hpp"
#include "archive/record_check.hpp"
#include "evolution/clones.hpp"
#include "evolution/resimulation.hpp"
#include "evolution/selection_table.hpp"
#include "life/measurement/combining.hpp"
#include "life/verification/verification.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/planted.hpp"
#include "support/refusals.hpp"
#include "support/runs.hpp"
#include "support/scorer.hpp"
#include "support/told.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using ::testing::ElementsAre, ::testing::Each;
using testing::naming, testing::planted, testing::Planted, testing::small, testing::Scorer, testing::score_by,
    testing::Told, testing::unwatched;

const Request brief{.settle = 0, .window = 0.02};
const std::string noisy = "experiment.birth_noise=0.01", three = "experiment.lives=3";

/// Returns the results of newborns, simulated by one thread one after the other.
std::vector<Result> results_of(const Experiment& experiment, std::span<const Newborn> newborns) {
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
  return Evaluation(experiment, *simulator).evaluate(newborns, unwatched);
}

/// Returns newborns that have these lives.
std::vector<Newborn> living(const std::vector<Individual>& individuals, std::uint32_t first, std::uint32_t lives) {
  std::vector<Newborn> newborns = testing::newborns_of(individuals);
  for (Newborn& newborn : newborns) {
    newborn.life = first;
    newborn.lives = lives;
  }
  return newborns;
}

TEST(Lives, ThatCannotDifferAreRefusedWithTheKeysThatLetThem) {
  const auto complaint = [](const std::vector<std::string>& values) {
    return testing::refusal<ConfigError>([&] { small(values); });
  };
  const std::string steady = "development.operator.0.name=spring-turnover";
  EXPECT_THAT(complaint({three}), naming("experiment.lives = 3", "birth_noise", "draws_between_lives", "start_noise"));
  const std::string undeveloped = complaint({three, "development.control=no-change"});
  EXPECT_THAT(undeveloped, naming("experiment.lives = 3", "birth_noise"));
  EXPECT_THAT(undeveloped, ::testing::Not(naming("draws_between_lives"))) << "nothing draws";
  EXPECT_THAT(complaint({three, "development.control=no-change", "development.draws_between_lives=new"}),
              naming("experiment.lives = 3"));
  EXPECT_THAT(complaint({"selection.remeasure=2"}), naming("selection.remeasure = 2", "birth_noise"));
  for (const std::string& differing :
       {noisy, std::string("development.draws_between_lives=new"), std::string("scenario=[{name='a', damage=0.1}]")}) {
    EXPECT_EQ(small({three, "selection.remeasure=2", differing}).lives, 3);
    EXPECT_EQ(testing::read(small({three, "selection.remeasure=2", differing}).resolved).remeasure, 2) << "recorded";
  }
}

TEST(Lives, OfWhichOnlyOneIsLuckOfEachRobotItsOwnAreWarnedOf) {
  const auto warnings = [](const std::vector<std::string>& values) { return small(values).warnings; };
  EXPECT_THAT(warnings({"development.draws=individual"}),
              ElementsAre(naming("development.draws = \"individual\"", "experiment.lives = 1", "inherited")));
  EXPECT_THAT(warnings({}), ElementsAre());
  EXPECT_THAT(warnings({"development.draws=individual", "development.control=no-change"}), ElementsAre());
  EXPECT_THAT(warnings({"development.draws=individual", three, noisy}), ElementsAre());
}

TEST(Lives, AreThoseOfEachNumberWhateverElseIsEvaluatedAndTheirScoresBecomeOne) {
  const std::string hurt = "scenario=[{name='hurt', damage=0.2, start_noise=0.01, repeat=2}]";
  for (const std::string draws : {"inherited", "individual"}) {
    SCOPED_TRACE(draws);
    const Experiment experiment =
        small({three, noisy, hurt, "development.draws=" + draws, "development.draws_between_lives=new"});
    const std::vector<Individual> individuals = breed(experiment, {}, 0, 0, 8);
    const std::vector<Result> all = results_of(experiment, living(individuals, 1, 3));
    std::vector<std::vector<Result>> alone;
    for (const std::uint32_t life : {1, 2, 3}) alone.push_back(results_of(experiment, living(individuals, life, 1)));
    std::size_t ok = 0, other_draws = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].status != Status::ok) continue;
      ++ok;
      std::uint64_t spring_evaluations = 0;
      std::set<double> scores;
      for (std::size_t life = 0; life < 3; ++life) {
        const Result& one = alone[life][i];
        EXPECT_EQ(all[i].lives.at(life), one.objectives);
        EXPECT_EQ(all[i].records.at(life), one.records.at(0));
        spring_evaluations += one.spring_evaluations;
        scores.insert(one.objectives[0]);
        for (std::size_t t = 0; t < one.tests.size(); ++t) {
          const TestScore& test = all[i].tests.at(life * one.tests.size() + t);
          EXPECT_EQ(test.life, life + 1);
          EXPECT_EQ(test.value, one.tests[t].value);
        }
      }
      EXPECT_EQ(scores.size(), 3u) << "lives differ";
      other_draws += all[i].records[0] != all[i].records[1];
      EXPECT_EQ(all[i].spring_evaluations, spring_evaluations);
      const auto& lives = all[i].lives;
      EXPECT_NEAR(all[i].objectives[0], (lives[0][0] + lives[1][0] + lives[2][0]) / 3, 1e-14 * std::abs(lives[0][0]));
    }
    EXPECT_GT(ok, 3u);
    EXPECT_GT(other_draws, 1u);
    testing::expect_independent_lives(experiment, individuals);
  }
}

/// The result of three lives, in the k-th of which an operator gives k-th scores of its objective, two measures of
/// other roles and a constraint.
Result scored(Over over, const std::vector<double>& goals, const std::vector<double>& limits = {-3, -2, -1}) {
  Experiment experiment = small({three, noisy});
  std::size_t life = 0;
  score_by(experiment, {{brief,
                         {{"goal", "m"},
                          {"place", "m", true, Role::descriptor, -1, 1},
                          {"note", "s", true, Role::measure},
                          {"limit", "N", true, Role::constraint}},
                         [&](const Observation&) {
                           const double k = static_cast<double>(life) + 1, limit = limits[life];
                           return std::vector{goals[life++], 10 * k, 20 * k * k, limit};
                         }}});
  experiment.over_lives = {over};
  const std::vector<Individual> one = breed(experiment, {}, 0, 0, 1);
  return results_of(experiment, living(one, 1, 3)).front();
}

TEST(Lives, AreSummedUpEachRoleInItsWay) {
  EXPECT_THAT(scored(Over::mean, {1, 2, 6}).objectives, ElementsAre(3));
  EXPECT_THAT(scored(Over::median, {1, 2, 6}).objectives, ElementsAre(2));
  EXPECT_THAT(scored(Over::worst, {4, 2, 6}).objectives, ElementsAre(2));
  EXPECT_THAT(scored(Over::worst, {1, 2, 3}).measures, ElementsAre(20, 20 * 14 / 3.0, -1)) << "mean, mean, worst";
  EXPECT_THAT(scored(Over::mean, {1, 2, 6}).lives, ElementsAre(ElementsAre(1), ElementsAre(2), ElementsAre(6)));
}

TEST(Lives, OfWhichOneFailsFailAndSayWhich) {
  const double nan = std::nan("");
  const Result failed = scored(Over::mean, {1, nan, nan});
  EXPECT_EQ(failed.status, Status::invalid);
  EXPECT_THAT(failed.reason, testing::at_place("life 2: ", "not finite", "goal"));
  EXPECT_TRUE(failed.objectives.empty() && failed.lives.empty() && failed.measures.empty());
  const Result infeasible = scored(Over::mean, {1, 2, 3}, {-1, 0.5, 4});
  EXPECT_EQ(infeasible.status, Status::invalid);
  EXPECT_THAT(infeasible.reason, testing::at_place("life 2: ", "limit", "0.5"));
  EXPECT_TRUE(infeasible.objectives.empty());
  EXPECT_EQ(infeasible.measures.back(), 4) << "how far it is from feasible: the worst";
  const double most = std::numeric_limits<double>::max();
  EXPECT_THAT(scored(Over::mean, {most, most, most}).reason, naming("mean of the lives", "goal"));
  EXPECT_EQ(scored(Over::median, {most, most, most}).objectives.at(0), most);
}

/// Newborns are moved by identity and life: with one mass less, the others are moved as before, if draws are inherited.
TEST(BirthNoise, MovesEachMassByItsIdentityAndTheLifeWithinTheGivenShare) {
  constexpr double share = 0.05;
  const auto offsets = [](const std::string& draws, std::uint32_t life, bool whole) {
    Experiment experiment = small({"development.draws=" + draws, "scene.gravity.acceleration=0"});
    Blueprint cube;
    const std::vector<std::uint64_t> identities{90, 91, 92, 93, 94};
    const std::vector<Vec3> places{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (!whole && i == 2) continue;
      cube.body.masses.push_back({places[i], 1});
      cube.identities.push_back(identities[i]);
    }
    const auto masses = static_cast<std::uint32_t>(cube.body.masses.size());
    for (std::uint32_t a = 0; a < masses; ++a)
      for (std::uint32_t b = a + 1; b < masses; ++b)
        cube.body.springs.push_back({a, b, norm(cube.body.masses[a].rest - cube.body.masses[b].rest), 1});
    experiment.encoding = std::make_unique<testing::GivenBlueprint>(cube);
    const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
    const auto positions = [&](double noise) {
      Conditions conditions(experiment);
      conditions.birth_noise = noise;
      const Genome genome;
      const Newborn newborn{.genome = &genome, .life = life};
      const Evaluation evaluation(experiment, *simulator, conditions);
      Life born = testing::alive(std::move(evaluation.birth.of({&newborn, 1}).front()));
      EXPECT_LT(std::ranges::min(born.living.state.position, {}, &Vec3::z).z, 1e-9) << "on the ground";
      EXPECT_NEAR(born.living.state.start_energy, total_energy(born.living.body, born.living.state, experiment.scene),
                  1e-12);
      return born;
    };
    const Life moved = positions(share), still = positions(0);
    std::map<std::uint64_t, Vec3> by_identity;
    for (std::size_t i = 0; i < moved.living.state.position.size(); ++i)
      by_identity[moved.living.numbers.identities()[i]] =
          moved.living.state.position[i] - still.living.state.position[i];
    return by_identity;
  };
  for (const std::string draws : {"inherited", "individual"}) {
    SCOPED_TRACE(draws);
    const auto first = offsets(draws, 1, true), second = offsets(draws, 2, true), less = offsets(draws, 1, false);
    std::size_t same_without_one = 0, same_in_another_life = 0;
    double most = 0;
    for (const auto& [identity, offset] : first) {
      most = std::max({most, std::abs(offset.x), std::abs(offset.y)});
      same_in_another_life += std::abs(offset.x - second.at(identity).x) < 1e-9;
      if (less.contains(identity)) same_without_one += std::abs(offset.x - less.at(identity).x) < 1e-12;
    }
    EXPECT_LE(most, share) << "of the longest side, 1 m";
    EXPECT_GT(most, share / 10);
    EXPECT_EQ(same_in_another_life, 0u);
    EXPECT_EQ(same_without_one, draws == "inherited" ? 4u : 2u);
  }
}

/// An encoding that counts how often it decodes.
struct Counting final : Encoding {
  std::unique_ptr<Encoding> encoding;
  mutable std::atomic<int> decoded = 0;

  explicit Counting(std::unique_ptr<Encoding> one) : encoding(std::move(one)) {}
  Layout layout(const EncodingContext& context) const override { return encoding->layout(context); }
  Blueprint decode(const Genome& genome, const Layout& layout, const EncodingContext& context) const override {
    ++decoded;
    return encoding->decode(genome, layout, context);
  }
};

TEST(Lives, DecodeEachGenomeOnceForAllScenesTheyDevelopIn) {
  Experiment experiment =
      small({three, noisy, "scenario=[{name='here', develops=true}, {name='there', develops=true, muscles=false}]"});
  auto counting = std::make_unique<Counting>(std::move(experiment.encoding));
  const Counting& counted = *counting;
  experiment.encoding = std::move(counting);
  const std::vector<Individual> individuals = breed(experiment, {}, 0, 0, 5);
  results_of(experiment, living(individuals, 1, 3));
  EXPECT_EQ(counted.decoded, 5);
}

TEST(Lives, AreKnownByNumberToOperatorsAndScores) {
  std::map<std::uint32_t, int> calls, scores;
  Experiment experiment =
      testing::with({Told({}, [&](const DevoContext& context, Edits&) { ++calls[context.life]; })},
                    testing::overrides({three, noisy, "scenario=[{name='here'}, {name='there', develops=true}]"}));
  score_by(experiment, {{brief, {{"number", "1"}}, [&](const Observation& seen) {
                           ++scores[seen.life];
                           return std::vector{static_cast<double>(seen.life)};
                         }}});
  const std::vector<Individual> one = breed(experiment, {}, 0, 0, 1);
  const Result all = results_of(experiment, living(one, 1, 3)).front();
  ASSERT_EQ(all.status, Status::ok) << all.reason;
  EXPECT_THAT(all.lives, ElementsAre(ElementsAre(1), ElementsAre(2), ElementsAre(3)));
  const std::map<std::uint32_t, int> four_each{{1, 4}, {2, 4}, {3, 4}}, two_each{{1, 2}, {2, 2}, {3, 2}};
  EXPECT_EQ(calls, four_each) << "in two scenes, of two cycles each";
  EXPECT_EQ(scores, two_each) << "in two scenarios";
  calls.clear(), scores.clear();
  results_of(experiment, living(one, 5, 1));
  EXPECT_EQ(calls, (std::map<std::uint32_t, int>{{5, 4}}));
  EXPECT_EQ(scores, (std::map<std::uint32_t, int>{{5, 2}}));
}

TEST(Lives, HaveTheSameDrawsUnlessTheExperimentAsksForNewOnes) {
  const std::vector<std::string> blind{three, "development.operator.0={name='spring-turnover', springs=2}",
                                       "scenario=[{name='shaken', start_noise=0.01}]"};
  for (const std::string draws : {"inherited", "individual"})
    for (const std::string between : {"same", "new"}) {
      std::vector<std::string> values = blind;
      values.insert(values.end(), {"development.draws=" + draws, "development.draws_between_lives=" + between});
      const Experiment experiment = small(values);
      const std::vector<Individual> one = breed(experiment, {}, 0, 0, 1);
      const Result result = results_of(experiment, living(one, 1, 3)).front();
      ASSERT_EQ(result.status, Status::ok);
      EXPECT_FALSE(result.records[0].empty());
      EXPECT_EQ(result.records[0] == result.records[1], between == "same") << draws;
      EXPECT_NE(result.lives[0], result.lives[1]) << "the noise is anew in each";
    }
}

TEST(Lives, OfARunAreInItsArchiveAndTheSameForAnyThreadsAndAfterInterruptions) {
  const std::vector<std::string> values{three,
                                        noisy,
                                        "development.draws_between_lives=new",
                                        "scenario=[{name='hurt', damage=0.2, repeat=2}]",
                                        "fitness.0.over_lives=worst",
                                        "experiment.evaluations=40",
                                        "experiment.population=8",
                                        "selection.remeasure=2",
                                        "experiment.verify_front=lives"};
  const Experiment experiment = small(values);
  const testing::FinishedRun straight(small(values));
  testing::Scratch scratch;
  for (const int threads : {1, 3}) {
    const std::string folder = "run-" + std::to_string(threads);
    {
      Archive archive = Archive::create(scratch / folder, experiment, straight.simulator->device());
      testing::evolve_to(1, experiment, archive, threads);
    }
    for (std::size_t generations = 2; generations <= 5; ++generations) {
      Archive archive = Archive::resume(scratch / folder);
      check_resumable(archive, experiment);
      testing::evolve_to(generations, experiment, archive, threads);
    }
    testing::expect_same_runs(straight.archive, Archive::read(scratch / folder));
  }
  std::set<std::uint32_t> numbers;
  std::map<std::uint32_t, int> recorded;
  for (std::uint32_t id = 0; const auto one = straight.archive.individual(id); ++id) {
    numbers.insert(one->lives);
    EXPECT_EQ(one->lives % 3, 0u);
    EXPECT_TRUE(one->lives > 3 || one->measured == one->born);
    const std::vector<LifeRecord> records = straight.archive.lives(id);
    if (!records.empty()) ++recorded[one->lives];
    EXPECT_LE(records.size(), one->lives);
    if (one->result.status != Status::ok) continue;
    ASSERT_EQ(one->result.lives.size(), one->lives);
    double worst = std::numeric_limits<double>::infinity();
    for (const std::vector<double>& life : one->result.lives) worst = std::min(worst, life[0]);
    EXPECT_EQ(one->result.objectives[0], worst) << id;
    EXPECT_EQ(straight.archive.tests(id).size(), 2 * experiment.objectives.size() * one->lives);
    // each life, with its number, gives its scores again
    const Newborn last{.id = id, .generation = one->born, .genome = &one->genome, .life = one->lives};
    EXPECT_EQ(results_of(experiment, {&last, 1}).front().objectives, one->result.lives.back()) << id;
  }
  EXPECT_THAT(numbers, ::testing::IsSupersetOf({3u, 6u}));
  int all_recorded = 0;
  for (const auto& [lives, count] : recorded) all_recorded += count;
  EXPECT_GE(all_recorded, 2) << "those on the front";
}

TEST(Lives, ThatAreRecordedHappenAgain) {
  testing::FinishedRun run(small({three, noisy, "development.draws_between_lives=new"}));
  // operators would draw the same numbers in each life
  run.experiment.development.draws_between_lives = DrawsBetweenLives::same;
  std::size_t checked = 0;
  for (const std::uint32_t id : run.archive.best(24)) {
    const ArchivedIndividual one = run.archive.known_individual(id);
    const Newborn again = for_resimulation(run.archive, run.experiment, one, run.simulator->device());
    if (again.records.empty()) continue;
    EXPECT_EQ(Evaluation(run.experiment, *run.simulator).evaluate({&again, 1}, unwatched).front().lives,
              one.result.lives);
    ++checked;
  }
  EXPECT_GE(checked, 2u);
}

TEST(Failures, OfAnyLifeCountByTheirCause) {
  testing::Scratch scratch;
  const Experiment experiment = small({three, noisy});
  Archive archive = Archive::create(scratch / "run", experiment, "a device");
  std::vector<Individual> newborns(5);
  const std::vector<std::string> reasons{"life 1: no springs", "life 3: no springs", "life 2: no extent",
                                         "life 2: mass 17 is lost", "life 1: mass 3 is lost"};
  for (std::uint32_t i = 0; i < newborns.size(); ++i) {
    newborns[i].id = i;
    newborns[i].lives = 3;
    newborns[i].genome = {1, 2};
    newborns[i].result = {.status = Status::invalid, .reason = reasons[i]};
  }
  archive.commit({.newborns = newborns, .summary = {.evaluations = 5, .invalid = 5}});
  std::map<std::string, std::int64_t> counts;
  for (const Failure& failure : archive.failures()) counts[failure.reason] = failure.count;
  EXPECT_THAT(counts, ElementsAre(std::pair("life 1: no springs", 2), std::pair("life 2: mass 17 is lost", 2),
                                  std::pair("life 2: no extent", 1)));
}

TEST(Remeasure, IsReadBesideTwoOperatorsToo) {
  const std::string both = "selection={parents={name='tournament'}, survivors={name='elitist'}, remeasure=2}";
  const Experiment experiment = small({noisy, both});
  EXPECT_EQ(experiment.remeasure, 2);
  EXPECT_EQ(testing::read(experiment.resolved).remeasure, 2);
  EXPECT_EQ(testing::read(experiment.resolved).resolved, experiment.resolved);
}

TEST(Cases, AreCombinedOverLives) {
  const Experiment experiment = small({three, "scenario=[{name='shaken', start_noise=0.01, repeat=2}]"});
  std::vector<Individual> everyone(1);
  everyone[0].result.objectives = {0, 0};
  for (const std::uint32_t life : {1, 2, 3})
    for (const int repeat : {0, 1}) everyone[0].result.tests.push_back({life, 0, repeat, 0, 10.0 * life + repeat});
  const SelectionTable table(everyone, experiment, 0);
  ASSERT_EQ(experiment.cases.size(), 4u);
  EXPECT_EQ(table.rows()[0].cases[0], 20);
  EXPECT_EQ(table.rows()[0].cases[1], 21);
}

/// Genomes of one gene, of which there are few, so that children are often equal to others.
TEST(TwinsOfOthers, TakeTheirScoresInsteadOfLivingAgainIfTheirLivesWouldBeTheSame) {
  const std::vector<std::string> few{"experiment.evaluations=60", "experiment.population=12", "encoding.size=[2, 1, 1]",
                                     "encoding.materials=['tissue', 'muscle']"};
  for (const std::string draws : {"inherited", "individual"}) {
    std::vector<std::string> values = few;
    values.insert(values.end(), {"development.draws=" + draws, "scenario=[{name='shaken', start_noise=0.01}]"});
    const testing::FinishedRun run(small(values));
    std::map<std::vector<float>, ArchivedIndividual> first;
    std::size_t copies = 0, others = 0;
    std::int64_t clones = 0;
    std::uint64_t all = 0, of_run = 0;
    for (const Summary& summary : run.archive.generations()) {
      clones += summary.clones;
      of_run += summary.spring_evaluations;
    }
    for (std::uint32_t id = 0; const auto one = run.archive.individual(id); ++id) {
      all += one->result.spring_evaluations;
      const auto [twin, is_new] = first.try_emplace(one->genome.genes, *one);
      if (is_new || one->result.status != Status::ok) continue;
      const bool is_equal = one->result.objectives == twin->second.result.objectives;
      (is_equal ? copies : others) += 1;
      if (!is_equal) continue;
      EXPECT_EQ(run.archive.tests(id).size(), run.archive.tests(twin->second.id).size());
      EXPECT_EQ(run.archive.tests(id).front().value, run.archive.tests(twin->second.id).front().value);
      EXPECT_EQ(one->result.spring_evaluations, 0u) << "it was not simulated";
    }
    EXPECT_EQ(all, of_run);
    EXPECT_GT(clones, 5);
    if (draws == "inherited") {
      EXPECT_GT(copies, 5u);
      EXPECT_EQ(others, 0u);
    } else {
      EXPECT_EQ(copies, 0u) << "each has its own draws";
    }
  }
}

TEST(TwinsOfOthers, HaveBlocksWithEqualIdsAndAFitnessThatCanBeFoundAgain) {
  const Experiment experiment = small();
  std::vector<Individual> population(2);
  for (std::uint32_t i = 0; i < 2; ++i) {
    population[i].id = i;
    population[i].genome = Genome{1, static_cast<float>(i)};
    population[i].genome.blocks = {{0, 0, 2, 7}};
  }
  population[1].result.status = Status::artefact;
  Individual newborn = population[0], other = population[0], failed = population[1];
  other.genome.blocks[0].id = 8;
  Twins twins(population, experiment, RecordedProvenances({0}));
  EXPECT_EQ(twins.find_or_add(newborn), &population[0]);
  EXPECT_EQ(twins.find_or_add(other), nullptr) << "identities may follow from ids";
  EXPECT_EQ(twins.find_or_add(failed), nullptr);
  EXPECT_EQ(Twins(population, experiment, RecordedProvenances({1})).find_or_add(newborn), nullptr)
      << "another device might find otherwise";
  EXPECT_EQ(Twins(population, small({"development.draws=individual"}), RecordedProvenances({0})).find_or_add(newborn),
            nullptr);
}

double mean_quality(const Archive& archive) {
  const std::vector<Individual> population = archive.population();
  double sum = 0;
  for (const Individual& one : population) sum += Planted::quality(one.genome);
  return sum / static_cast<double>(population.size());
}

TEST(Remeasure, LetsMembersMeasuredLongestAgoLiveAgainAndTheirScoresFollow) {
  const testing::FinishedRun run(planted({"experiment.evaluations=200", "selection.remeasure=3"}));
  std::size_t again = 0;
  for (std::uint32_t id = 0; const auto one = run.archive.individual(id); ++id) {
    ASSERT_EQ(one->result.lives.size(), one->lives);
    double sum = 0;
    for (const std::vector<double>& life : one->result.lives) sum += life[0];
    EXPECT_NEAR(one->result.objectives[0], sum / one->lives, 1e-12);
    EXPECT_EQ(std::set(one->result.lives.begin(), one->result.lives.end()).size(), one->lives) << "each is another";
    EXPECT_GE(one->measured, one->born);
    again += one->lives - 1;
  }
  EXPECT_EQ(again, 3 * (run.archive.generations().size() - 1)) << "three in each generation but the first";
  std::vector<std::uint32_t> measured;  // of those that live, each of whom has its turn
  for (const Individual& one : run.archive.population()) measured.push_back(one.measured);
  const auto last = static_cast<std::uint32_t>(run.archive.generations().size() - 1);
  EXPECT_GE(*std::ranges::min_element(measured) + 20 / 3 + 1, last);
}

/// It does not where populations are tiny: among five, chance picks who stays, and more lives cost what they bring.
TEST(Remeasure, FindsBetterGenomesAtEqualCostInALargePopulationOfLuckyElders) {
  int better = 0;
  double gain = 0;
  constexpr int seeds = 6;
  for (int seed = 0; seed < seeds; ++seed) {
    const std::vector<std::string> values{"experiment.seed=" + std::to_string(seed), "experiment.population=100"};
    const auto run = [&](std::vector<std::string> more) {
      more.insert(more.end(), values.begin(), values.end());
      return testing::FinishedRun(planted(more));
    };
    const testing::FinishedRun elders = run({"experiment.evaluations=4000"}),
                               again = run({"experiment.evaluations=3350", "selection.remeasure=20"});
    const auto cost = [](const Archive& archive) {
      std::uint64_t sum = 0;
      for (const Summary& summary : archive.generations()) sum += summary.spring_evaluations;
      return static_cast<double>(sum);
    };
    EXPECT_NEAR(cost(again.archive) / cost(elders.archive), 1, 0.01);
    const double more = mean_quality(again.archive) - mean_quality(elders.archive);
    better += more > 0;
    gain += more / seeds;
  }
  EXPECT_GE(better, 5);
  EXPECT_GT(gain, 0.02);
}

TEST(VerifyFront, WithLivesRefusesThoseWhoseFitnessWasLuck) {
  const auto refused = [](const char* how, double noise) {
    Experiment experiment = planted({"experiment.evaluations=200"}, noise);
    experiment.verify_front = how == std::string("lives") ? VerifyFront::lives : VerifyFront::trials;
    experiment.objectives[0].maximise = false;  // so that those that move by themselves are not asked for
    const testing::FinishedRun run(std::move(experiment));
    std::int64_t lucky = 0;
    for (const Summary& summary : run.archive.generations()) lucky += summary.lucky;
    EXPECT_EQ(run.archive.statuses().at("lucky"), lucky);
    for (std::uint32_t id = 0; const auto one = run.archive.individual(id); ++id) {
      if (one->result.status != Status::lucky) continue;
      EXPECT_THAT(one->result.reason, testing::at_place("new-lives gives ", "the run gave "));
      EXPECT_TRUE(one->result.objectives.empty());
    }
    return lucky;
  };
  EXPECT_EQ(refused("trials", 5), 0);
  EXPECT_GT(refused("lives", 5), 5);
  EXPECT_EQ(refused("lives", 0), 0) << "without luck, all hold";
}

/// The score of a robot follows from the draws of its development alone.
TEST(LivesToCome, HaveTheDrawsOfTheRunOrNewOnes) {
  for (const std::string between : {"same", "new"}) {
    Experiment experiment =
        testing::with({Told({},
                            [](const DevoContext& context, Edits& edits) {
                              edits.change_spring(0, {.stiffness_factor = 1 + context.draw({"which", 0})});
                            })},
                      testing::overrides({"development.draws_between_lives=" + between, noisy, "experiment.lives=2"}));
    score_by(experiment, {{brief, {{"drawn", "1"}}, [](const Observation& seen) {
                             return std::vector{seen.body->springs[0].stiffness_factor};
                           }}});
    const std::vector<Individual> one = breed(experiment, {}, 0, 0, 1);
    const auto simulator = testing::simulator_for(experiment);
    const Newborn newborn = living(one, 1, 2).front();
    const Result seen = Evaluation(experiment, *simulator).evaluate({&newborn, 1}, unwatched).front();
    ASSERT_EQ(seen.status, Status::ok) << seen.reason;
    const Champion champion{newborn, seen.objectives[0]};
    const Verification found = verify(experiment, *simulator, {&champion, 1}).front();
    std::map<std::string, double> value;
    for (const Trial& trial : found.trials) value[trial.name] = trial.value.value();
    EXPECT_EQ(value.at("again"), seen.objectives[0]);
    for (const int birth : {1, 2, 3, 4})
      EXPECT_EQ(value.at("reborn-" + std::to_string(birth)), seen.lives.at((birth - 1) % 2).at(0));
    std::set<double> redrawn;
    for (const int birth : {1, 2, 3, 4}) redrawn.insert(value.at("redrawn-" + std::to_string(birth)));
    EXPECT_EQ(redrawn.size(), 4u);
    for (const std::vector<double>& life : seen.lives) EXPECT_FALSE(redrawn.contains(life[0]));
    EXPECT_EQ(verify(experiment, *simulator, {&champion, 1}, VerifiedLives::seen).front().trials.size(),
              found.trials.size() - 2 * births);
  }
}

TEST(LivesToCome, ChooseTheBestByTheFirstAndAreToldByTheOthers) {
  const auto verified = [](std::uint32_t id, std::vector<double> same, std::vector<double> redrawn) {
    Verification one{id, 4, {{"again", Status::ok, "", 4}}};
    for (std::size_t i = 0; i < same.size(); ++i)
      one.trials.push_back({reborn_trial + std::to_string(i + 1), Status::ok, "", same[i]});
    for (std::size_t i = 0; i < redrawn.size(); ++i)
      one.trials.push_back({redrawn_trial + std::to_string(i + 1), Status::ok, "", redrawn[i]});
    return one;
  };
  const Objective distance{"distance", "m"};
  std::vector<Verification> all{verified(1, {3, 3, 9, 9}, {9, 9, 9, 9}), verified(2, {4, 5, 1, 2}, {1, 1.5, 2.5, 3}),
                                verified(3, {4, -1, 9, 9}, {9, 9, 9, 9})};
  EXPECT_EQ(verdict_text(all[1], true),
            "verified, kept in 3 of 4 lives to come with the same draws and in 2 of 4 with new ones");
  EXPECT_THAT(choice_text(all, distance), naming("individual 2 ", "these 3", "distance 1.5 m", "2 m with new"));
  EXPECT_THAT(choice_text(all, {"distance", "m", false}), naming("individual 3 ", "9 m"));
  all[1].trials[1] = {"reborn-1", Status::diverged, "so", std::nullopt};
  EXPECT_THAT(choice_text(all, distance), naming("individual 1 "));
  EXPECT_EQ(choice_text({&all[0], 1}, distance), "") << "there is nothing to choose";
  EXPECT_EQ(verdict_text({0, 4, {{"again", Status::ok, "", 4}}}, true), "verified");
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
