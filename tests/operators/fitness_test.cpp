#include <cmath>
#include <stdexcept>

#include "support.hpp"

namespace evodevo::test {
namespace {

/// An observation of a body that is 2 m long and moves by (3, 4, 1) m; `offset` shifts it.
Observation moved(Vec3 offset = {}) {
  return {{offset, offset + Vec3{1, 2, 0.5}}, offset + Vec3{5, 5, 5}, offset + Vec3{8, 9, 6}, 10, 0};
}

double distance(const std::string& toml, const Observation& observation) {
  const auto scores = make<Fitness>("distance", toml)->score(observation);
  EXPECT_EQ(scores.size(), 1u);
  return scores.at(0);
}

TEST(Distance, IsTheWayInBodyLengths) {
  EXPECT_DOUBLE_EQ(distance("", moved()), 1.5);
  EXPECT_DOUBLE_EQ(distance("direction = [0, 1, 0]", moved()), 2);
  EXPECT_DOUBLE_EQ(distance("direction = [0, 0, -1]", moved()), -0.5);
  EXPECT_DOUBLE_EQ(distance("direction = [1, 1, 0]", moved()), 7 / std::sqrt(2.0) / 2);
}

TEST(Distance, DoesNotDependOnTheDirectionsLength) {
  for (const auto* toml : {"direction = [1, 0, 0]", "direction = [0.001, 0, 0]", "direction = [900, 0, 0]"})
    EXPECT_NEAR(distance(toml, moved()), 1.5, 1e-12);
}

TEST(Distance, DoesNotDependOnThePlace) { EXPECT_NEAR(distance("", moved({1000, -500, 20})), 1.5, 1e-9); }

TEST(Distance, BodiesWithoutLengthHaveNone) {
  Observation point = moved();
  point.box = {{1, 1, 1}, {1, 1, 1}};
  EXPECT_TRUE(std::isnan(distance("", point)));
  point.centre_after = point.centre_before;
  EXPECT_TRUE(std::isnan(distance("", point)));
}

TEST(Distance, IsHonestAboutWhatIsNoNumber) {
  Observation lost = moved();
  lost.centre_after.x = std::nan("");
  EXPECT_FALSE(std::isfinite(distance("", lost)));
  Observation exploded = moved();
  exploded.box.high.y = std::nan("");
  EXPECT_FALSE(std::isfinite(distance("", exploded)));
}

TEST(Distance, AsksForItsWindow) {
  const Request usual = make<Fitness>("distance")->observes();
  EXPECT_EQ(usual.settle, 10);
  EXPECT_EQ(usual.window, 10);
  EXPECT_FALSE(usual.work);
  const Request paper = make<Fitness>("distance", "settle = 3.0\nwindow = 5.0")->observes();
  EXPECT_EQ(paper.settle, 3);
  EXPECT_EQ(paper.window, 5);
}

TEST(Distance, RefusesNoDirection) {
  const auto fitness = make<Fitness>("distance", "direction = [0, 0, 0]");
  EXPECT_THAT([&] { fitness->observes(); },
              testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("direction")));
}

TEST(Distance, IsToBeGreat) {
  const auto objectives = make<Fitness>("distance")->objectives();
  ASSERT_EQ(objectives.size(), 1u);
  EXPECT_EQ(objectives[0].name, "distance");
  EXPECT_EQ(objectives[0].unit, "body lengths");
  EXPECT_TRUE(objectives[0].maximise);
}

TEST(ActuationWork, IsTheWorkAndToBeSmall) {
  const auto fitness = make<Fitness>("actuation-work", "settle = 0.0\nwindow = 2.0");
  const auto objectives = fitness->objectives();
  ASSERT_EQ(objectives.size(), 1u);
  EXPECT_EQ(objectives[0].name, "actuation-work");
  EXPECT_EQ(objectives[0].unit, "J");
  EXPECT_FALSE(objectives[0].maximise);
  EXPECT_TRUE(fitness->observes().work);
  EXPECT_EQ(fitness->observes().settle, 0);
  EXPECT_EQ(fitness->observes().window, 2);
  Observation observation = moved();
  observation.work = 12.5;
  EXPECT_EQ(fitness->score(observation), std::vector{12.5});
}

TEST(AnyFitness, JudgesTheSameSecondsByDefault) {
  const Request distance = make<Fitness>("distance")->observes(), work = make<Fitness>("actuation-work")->observes();
  EXPECT_EQ(distance.settle, work.settle);
  EXPECT_EQ(distance.window, work.window);
}

TEST(AnyFitness, GivesTheSameOnAnyThread) {
  const auto fitness = make<Fitness>("distance", "direction = [1, 2, 3]");
  from_eight_threads([&] { return fitness->score(moved()); });
}

}  // namespace
}  // namespace evodevo::test
