// Lives as they are filmed: filming changes no result and leaves no gap.
#include "report/filming.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>

#include "support/changed.hpp"
#include "support/lives.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

/// Returns the small experiment with other devo operators, and additional keys of development.
std::string with_development(const std::string& keys, const std::string& operators) {
  return testing::small_with(
      {{"[[development.operator]]\nname = \"spring-turnover\"\nsprings = 2\n", keys + operators}});
}

std::vector<FilmedLife> filmed_lives(const std::string& text, std::size_t count) {
  const Experiment experiment = testing::read(text);
  const std::vector<Individual> individuals = breed(experiment, {}, 0, 0, count);
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 2);
  return film_lives(experiment, *simulator, testing::newborns_of(individuals));
}

const std::string turnover = "[[development.operator]]\nname = 'spring-turnover'\nsprings = 2\n";
const std::string tallied = with_development("probe = 'skip-shift'\nskip = 7\n", turnover);

TEST(Filming, ChangesNoResult) {
  for (const std::string& text :
       {testing::small_experiment, tallied, with_development("control = 'random-places'\n", turnover)}) {
    SCOPED_TRACE(text);
    const Experiment experiment = testing::read(text);
    const std::vector<Individual> individuals = breed(experiment, {}, 0, 0, 12);
    const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 2);
    const std::vector<Result> plain =
        Evaluation(experiment, *simulator).evaluate(testing::newborns_of(individuals), [](double) {});
    const std::vector<FilmedLife> filmed = filmed_lives(text, 12);
    ASSERT_EQ(filmed.size(), plain.size());
    for (std::size_t i = 0; i < plain.size(); ++i) {
      EXPECT_EQ(filmed[i].result.status, plain[i].status);
      EXPECT_EQ(filmed[i].result.spring_evaluations, plain[i].spring_evaluations);
      EXPECT_EQ(filmed[i].result.objectives, plain[i].objectives);
      EXPECT_EQ(filmed[i].result.records, plain[i].records);
    }
  }
}

TEST(Filming, ReachesFromBirthToTheEndWithoutAGap) {
  std::size_t lives = 0;
  for (const FilmedLife& life : filmed_lives(testing::small_experiment, 12)) {
    if (life.result.status != Status::ok) continue;
    ++lives;
    ASSERT_EQ(life.film.size(), 4u);  // two cycles, settling, the window
    EXPECT_EQ(life.cycles, 2u);
    double time = 0;
    for (const Shot& shot : life.film) {
      EXPECT_NEAR(shot.frames.front().time, time, 1e-9);
      for (const Frame& frame : shot.frames) EXPECT_EQ(frame.positions.size(), shot.body.masses.size());
      EXPECT_EQ(shot.stress.size(), shot.body.springs.size());
      time = shot.frames.back().time;
    }
    EXPECT_NEAR(time, 2 * 0.05 + 0.15, 1e-9);
    EXPECT_EQ(life.film.back().frames.size(), 7u);  // 60 per second for 0.1 s, and the first one
  }
  EXPECT_GT(lives, 4u);
}

TEST(Filming, MassesKeepTheirNumbers) {
  const std::string text =
      with_development("", turnover + "[[development.operator]]\nname = 'mass-turnover'\nlimit = 2\nsprings = 4\n");
  std::size_t come = 0, gone = 0;
  for (const FilmedLife& life : filmed_lives(text, 12)) {
    std::map<std::uint32_t, Mass> known;
    for (const Shot& shot : life.film) {
      ASSERT_EQ(shot.numbers.size(), shot.body.masses.size());
      EXPECT_EQ(std::ranges::adjacent_find(shot.numbers, std::greater_equal()), shot.numbers.end());
      for (std::size_t i = 0; i < shot.numbers.size(); ++i) {
        const auto [found, is_new] = known.try_emplace(shot.numbers[i], shot.body.masses[i]);
        come += is_new && &shot != &life.film.front();
        EXPECT_EQ(found->second.rest, shot.body.masses[i].rest);
      }
    }
    if (!life.film.empty()) gone += known.size() - life.film.back().numbers.size();
  }
  EXPECT_GT(come, 0u);
  EXPECT_GT(gone, 0u);
}

TEST(Filming, ACycleOfManyRunsIsOneShot) {
  const Film exact = filmed_lives(with_development("", turnover), 1).front().film;
  const Film tallies = filmed_lives(tallied, 1).front().film;  // a tally every 3.5 ms
  ASSERT_EQ(exact.size(), 4u);
  ASSERT_EQ(tallies.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    const std::vector<Frame>& frames = tallies[i].frames;
    EXPECT_EQ(frames.front().time, exact[i].frames.front().time);
    EXPECT_NEAR(frames.back().time, exact[i].frames.back().time, 1e-12);
    for (std::size_t f = 1; f < frames.size(); ++f) EXPECT_GT(frames[f].time, frames[f - 1].time);
    EXPECT_GE(frames.size(), exact[i].frames.size());
    EXPECT_LE(frames.size(), 2 * exact[i].frames.size());
  }
  // the body at birth is the same, so its stress is the same up to rounding
  ASSERT_EQ(tallies.front().stress.size(), exact.front().stress.size());
  for (std::size_t s = 0; s < exact.front().stress.size(); ++s)
    EXPECT_NEAR(tallies.front().stress[s], exact.front().stress[s], 1e-4 * exact.front().stress[s] + 1e-6);
}

TEST(Filming, RecordsWhatARunInOneGoRecords) {
  const Experiment experiment = testing::small();
  const std::vector<Individual> individuals = breed(experiment, {}, 0, 0, 1);
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
  FilmingSimulator camera(*simulator, filmed_frames_per_second);
  Life life = Evaluation(experiment, *simulator).birth.of(testing::newborns_of(individuals)).front();
  ASSERT_TRUE(life.alive());
  const auto answer = [&](Simulator& by, const Recording& recording) {
    State state = life.living.state;
    Task task{.body = &life.living.body, .state = &state, .steps = 333};
    by.run({&task, 1}, recording);
    return task;
  };
  const Recording everything{.stress = true, .work = true, .peak_force = true, .muscle_work = true, .tension = true};
  const Task whole = answer(*simulator, everything), filmed = answer(camera, everything), nothing = answer(camera, {});
  for (const auto list : SpringRecords::lists) {
    EXPECT_EQ(filmed.*list, whole.*list);
    EXPECT_TRUE((nothing.*list).empty());
  }
  EXPECT_GT(whole.work, 0);
  EXPECT_EQ(filmed.work, whole.work);
  EXPECT_EQ(filmed.spring_evaluations, whole.spring_evaluations);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
