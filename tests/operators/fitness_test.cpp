#include <cmath>
#include <stdexcept>

#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// An observation of a body that is 2 m long, moves by (3, 4, 1) m, and does some work.
Observation moved(double work = 0) { return {{{}, {1, 2, 0.5}}, {5, 5, 5}, {8, 9, 6}, 10, work}; }

double distance(const std::string& toml, const Observation& observation) {
  const auto scores = make<Fitness>("distance", toml)->score(observation);
  EXPECT_EQ(scores.size(), 1u);
  return scores.at(0);
}

TEST(Distance, IsTheWayInBodyLengthsOrInAGivenLength) {
  EXPECT_DOUBLE_EQ(distance("direction = [0, 1, 0]", moved()), 2);
  EXPECT_DOUBLE_EQ(distance("direction = [0, 0, -1]", moved()), -0.5);
  EXPECT_DOUBLE_EQ(distance("direction = [1, 1, 0]", moved()), 7 / std::sqrt(2.0) / 2);
  for (const auto* toml : {"", "direction = [1, 0, 0]", "direction = [0.001, 0, 0]", "direction = [900, 0, 0]"})
    EXPECT_NEAR(distance(toml, moved()), 1.5, 1e-12) << toml;
  EXPECT_DOUBLE_EQ(distance("length = 0.5", moved()), 6);
  Observation longer = moved();
  longer.box.high.z += 10;
  EXPECT_DOUBLE_EQ(distance("length = 0.5", longer), 6);
}

/// An observation of a body 2 m long that first moves by `first`, in the first fifth of its window, and by `way` in
/// all.
struct Turning {
  std::vector<StoredSample> stored;
  Observation observation = moved();

  Turning(Vec3 first, Vec3 way) : stored(6) {
    observation.centre_after = observation.centre_before + way;
    for (StoredSample& sample : stored) sample.centre = observation.centre_after;
    stored[0].centre = observation.centre_before;
    stored[1].centre = observation.centre_before + first;
    std::vector<const StoredSample*> samples;
    for (const StoredSample& sample : stored) samples.push_back(&sample);
    observation.samples = Samples(samples, {.centre = true});
  }
};

TEST(Distance, InAnyDirectionIsTheWayAlongTheGroundAndAlongTheHeadingThatWhichKeepsItsCourse) {
  EXPECT_DOUBLE_EQ(distance("direction = 'any'", moved()), 2.5) << "(3, 4) m, 2 m long; the height counts for nothing";
  const struct {
    Vec3 first, way;
    double lengths;
  } cases[] = {{{0, 0.1, 0}, {0, 4, 0}, 2},   {{0, 0.1, 5}, {3, 4, 0}, 2}, {{0.1, 0, 0}, {0, 4, 0}, 0},
               {{-0.1, 0, 0}, {4, 0, 0}, -2}, {{0, 0, 0}, {3, 4, 0}, 0},   {{0.3, 0.4, 0}, {3, 4, -9}, 2.5}};
  for (const auto& [first, way, lengths] : cases)
    EXPECT_NEAR(distance("direction = 'heading'", Turning(first, way).observation), lengths, 1e-12);
  EXPECT_TRUE(std::isnan(distance("direction = 'heading'", Turning({std::nan(""), 0, 0}, {1, 0, 0}).observation)));
  const Request request = make<Fitness>("distance", "direction = 'heading'\nwindow = 4.0")->observes();
  EXPECT_EQ(request.rate, 1.25) << "a sample at each fifth";
  EXPECT_TRUE(request.channels.centre);
  EXPECT_EQ(make<Fitness>("distance", "direction = 'any'")->observes().rate, 0) << "what is not needed is not sampled";
  Observation worked = moved(20);
  EXPECT_DOUBLE_EQ(make<Fitness>("efficiency", "direction = 'any'")->score(worked).at(0), 5 / 20.0);
}

TEST(Distance, IsNoNumberWhereTheBodyHasNoLengthOrAPlaceIsNoNumber) {
  Observation point = moved(), still = moved(), lost = moved(), exploded = moved();
  point.box = still.box = {{1, 1, 1}, {1, 1, 1}};
  still.centre_after = still.centre_before;
  lost.centre_after.x = std::nan("");
  exploded.box.high.y = std::nan("");
  for (const Observation& seen : {point, still, lost, exploded}) EXPECT_TRUE(std::isnan(distance("", seen)));
}

TEST(Distance, AsksForItsWindow) {
  const Request usual = make<Fitness>("distance")->observes();
  EXPECT_EQ(usual.settle, 10);
  EXPECT_EQ(usual.window, 10);
  EXPECT_FALSE(usual.work);
  EXPECT_FALSE(usual.cycle.has_value()) << "after maturing";
  const Request growing = make<Fitness>("distance", "developing = true\nsettle = 0.5\nwindow = 5.0")->observes();
  EXPECT_EQ(growing.settle, 0.5);
  EXPECT_EQ(growing.window, 5);
  EXPECT_EQ(growing.cycle, 0) << "from birth on";
}

TEST(AnyFitness, WithADirectionRefusesNone) {
  for (const char* name : {"distance", "efficiency"})
    EXPECT_THAT([&] { make<Fitness>(name, "direction = [0, 0, 0]")->observes(); },
                ::testing::ThrowsMessage<std::invalid_argument>(::testing::HasSubstr("direction")));
}

TEST(AnyFitness, IsToBeGreatUnlessItIsACost) {
  for (const auto& [name, unit, is_cost] :
       {std::tuple{"distance", "body lengths", false}, {"actuation-work", "J", true}}) {
    const auto objectives = make<Fitness>(name)->objectives();
    ASSERT_EQ(objectives.size(), 1u);
    EXPECT_EQ(objectives[0].name, name);
    EXPECT_EQ(objectives[0].unit, unit);
    EXPECT_EQ(objectives[0].maximise, !is_cost);
  }
}

TEST(ActuationWork, IsTheWork) {
  const auto fitness = make<Fitness>("actuation-work", "settle = 0.0\nwindow = 2.0");
  EXPECT_TRUE(fitness->observes().work);
  EXPECT_EQ(fitness->observes().settle, 0);
  EXPECT_EQ(fitness->observes().window, 2);
  EXPECT_EQ(fitness->score(moved(12.5)), std::vector{12.5});
}

/// A body whose centre of mass is at given places, 0.1 s apart; its box reaches 0.5 m to all sides.
class Path {
 public:
  Path(const Fitness& fitness, const std::vector<Vec3>& places) {
    const Vec3 half{0.5, 0.5, 0.5};
    for (double time = 3; const Vec3& place : places) {
      samples_.push_back({.time = time, .centre = place, .box = {place - half, place + half}});
      time += 0.1;
    }
    std::vector<const StoredSample*> all;
    for (const StoredSample& sample : samples_) all.push_back(&sample);
    seen = {.box = samples_.front().box, .centre_before = places.front(), .centre_after = places.back()};
    seen.samples = Samples(all, fitness.observes().channels);
  }
  Path(const Path&) = delete;

  StoredSample& sample(std::size_t i) { return samples_[i]; }

  Observation seen;

 private:
  std::vector<StoredSample> samples_;
};

double score_of(const std::string& name, const std::string& toml, const std::vector<Vec3>& places) {
  const auto fitness = make<Fitness>(name, toml);
  return fitness->score(Path(*fitness, places).seen).at(0);
}

TEST(Jump, IsTheHighestOfAllHeights) {
  EXPECT_DOUBLE_EQ(score_of("jump", "", {{0, 0, 1}, {1, 0, 1.5}, {2, 0, 3}, {3, 0, 0.2}}), 2);
  EXPECT_DOUBLE_EQ(score_of("jump", "", {{0, 0, 1}, {0, 0, 0.5}}), 0) << "it only falls";
  const double nan = std::nan("");
  EXPECT_TRUE(std::isnan(score_of("jump", "", {{nan, nan, nan}, {nan, nan, nan}})));
  EXPECT_EQ(make<Fitness>("jump", "rate = 250.0")->observes().rate, 250);
}

TEST(Reach, IsTheSmallestOfAllDistances) {
  const std::vector<Vec3> places{{5, 5, 1}, {6, 5, 1}, {7, 5, 2}, {9, 9, 9}};
  EXPECT_DOUBLE_EQ(score_of("reach", "target = [2, 0, 0]", places), 1);
  EXPECT_DOUBLE_EQ(score_of("reach", "target = [2.0, 0.0, 1.0]", places), 0);
  EXPECT_DOUBLE_EQ(score_of("reach", "target = [-1, 0, 0]", places), 1) << "it never comes nearer";
  EXPECT_FALSE(make<Fitness>("reach")->objectives().at(0).maximise);
}

TEST(Straightness, ComparesTheWayWithThePath) {
  EXPECT_DOUBLE_EQ(score_of("straightness", "", {{0, 0, 0}, {1, 0, 7}, {2, 0, 3}}), 1) << "heights do not count";
  EXPECT_DOUBLE_EQ(score_of("straightness", "", {{0, 0, 0}, {3, 0, 0}, {3, 4, 0}}), 5.0 / 7);
  EXPECT_DOUBLE_EQ(score_of("straightness", "", {{0, 0, 0}, {3, 0, 0}, {0, 0, 0}}), 0);
  EXPECT_DOUBLE_EQ(score_of("straightness", "", {{1, 2, 0}, {1, 2, 0}}), 0) << "it does not move";
}

TEST(Efficiency, IsTheWayForTheWork) {
  const auto score = [](const std::string& toml, double work) {
    return make<Fitness>("efficiency", toml)->score(moved(work)).at(0);
  };
  EXPECT_DOUBLE_EQ(score("", 60), 3.0 / 60);
  EXPECT_DOUBLE_EQ(score("direction = [0, -2, 0]", 60), -4.0 / 60);
  EXPECT_DOUBLE_EQ(score("", 1e-9), 3.0 / 10) << "a body at rest gains nothing by resting more";
  EXPECT_DOUBLE_EQ(score("least_work = 0.5", 0), 3.0 / 0.5);
  EXPECT_TRUE(std::isnan(score("", std::nan(""))));
}

TEST(Descriptor, HasARangeAndTheRoleOfOne) {
  const auto fitness = make<Fitness>("descriptor", "what = 'height'\nrange = [0.5, 1.5]");
  const Objective described = fitness->objectives().at(0);
  EXPECT_EQ(described.name, "height");
  EXPECT_EQ(described.role, Role::descriptor);
  EXPECT_EQ(described.low, 0.5);
  EXPECT_EQ(described.high, 1.5);
  for (const char* what : {"height", "contact", "spread", "masses"}) {
    const Objective usual = make<Fitness>("descriptor", std::string("what = '") + what + "'")->objectives().at(0);
    EXPECT_LT(usual.low, usual.high) << what;
  }
  for (const char* range : {"[1.0]", "[2.0, 1.0]", "[1.0, 1.0]", "[1.0, 2.0, 3.0]"})
    EXPECT_THAT([&] { make<Fitness>("descriptor", std::string("range = ") + range); },
                ::testing::ThrowsMessage<InputError>(::testing::HasSubstr("range")));
}

TEST(Descriptor, IsTheMeanOverTheWindow) {
  const auto fitness = [](const std::string& what) { return make<Fitness>("descriptor", "what = '" + what + "'"); };
  const auto mean = [&](const std::string& what, const std::vector<Vec3>& sizes) {
    const auto descriptor = fitness(what);
    Path path(*descriptor, {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}});
    for (std::size_t i = 0; i < 3; ++i) path.sample(i).box = {{1, 1, 1}, Vec3{1, 1, 1} + sizes[i]};
    return descriptor->score(path.seen).at(0);
  };
  EXPECT_DOUBLE_EQ(mean("height", {{3, 2, 9}, {3, 2, 1}, {3, 2, 2}}), 1.5);
  EXPECT_DOUBLE_EQ(mean("spread", {{9, 9, 9}, {3, 2, 8}, {4, 2, 7}}), 3.5) << "the longer horizontal side";
  EXPECT_DOUBLE_EQ(mean("spread", {{9, 9, 9}, {3, 2, 8}, {1, 4, 7}}), 3.5);
  const auto contact = fitness("contact");
  Path path(*contact, {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}});
  path.sample(1).contact_time = 0.02;  // 0.1 s lie between two samples
  path.sample(2).contact_time = 0.08;
  EXPECT_NEAR(contact->score(path.seen).at(0), (0.2 + 0.6) / 2, 1e-12);
  Body body;
  body.masses.resize(17);
  Observation seen = moved();
  seen.body = &body;
  EXPECT_EQ(fitness("masses")->score(seen), std::vector{17.0});
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
