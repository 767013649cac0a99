// Verification before the front: who does not hold loses the fitness, and who comes to the front instead is verified
// too.
#include "evolution/front_verification.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <numbers>

#include "evolution/selection_table.hpp"
#include "support/changed.hpp"
#include "support/lives.hpp"
#include "support/messages.hpp"
#include "support/pairs.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using testing::exaggerated, testing::measured_step, testing::strain;

/// Pairs that oscillate in empty space, and their verification.
class Pairs : public ::testing::Test {
 protected:
  /// Adds a newborn, and returns its fitness.
  double add(double h, bool is_passive = false) {
    Individual& one = everyone_.emplace_back();
    one.id = static_cast<std::uint32_t>(everyone_.size() - 1);
    one.genome = {static_cast<float>(h), is_passive ? 1.0F : 0.0F};
    const Newborn newborn{one.id, 0, &one.genome};
    one.result = Evaluation(experiment_, *simulator_).evaluate({&newborn, 1}, [](double) {}).front();
    return one.result.objectives.at(0);
  }
  /// Adds a pair that swings back and forth an odd number of times until it is measured, at its full elongation.
  double add_honest() { return add(std::numbers::pi / measured_step); }

  Status status(std::size_t i) const { return everyone_[i].result.status; }
  const std::string& reason(std::size_t i) const { return everyone_[i].result.reason; }

  testing::Scratch scratch_;
  Experiment experiment_ = testing::pairs();
  std::unique_ptr<Simulator> simulator_ = make_cpu_simulator(experiment_.scene, experiment_.stepping, 2);
  LocalEvaluator evaluator_{experiment_, *simulator_};
  RecordedProvenances provenances_{{0}};
  FrontVerification verification_{experiment_, evaluator_, provenances_};
  std::vector<Individual> everyone_;
};

TEST_F(Pairs, TheNextInLineAreVerifiedWhenTheFirstFallAndWhoHoldsStaysOk) {
  EXPECT_NEAR(add_honest(), strain, 1e-3);
  const double second = add(exaggerated(2.3)), first = add(exaggerated(2.6));
  ASSERT_GT(second, 2.2 * strain);
  ASSERT_GT(first, second);
  const std::vector<Refusal> refusals = verification_.refuse(everyone_, 0);
  ASSERT_EQ(refusals.size(), 2u);
  EXPECT_EQ(refusals[0].individual, 2u) << "it alone was on the front";
  EXPECT_EQ(refusals[1].individual, 1u);
  EXPECT_EQ(refusals[0].reason, reason(2));
  for (const std::size_t i : {1, 2}) {
    EXPECT_EQ(status(i), Status::artefact);
    EXPECT_THAT(reason(i), testing::naming("quarter-step", " m", short_number(i == 1 ? second : first)));
    EXPECT_TRUE(everyone_[i].result.objectives.empty());
  }
  EXPECT_EQ(status(0), Status::ok) << reason(0);
}

TEST_F(Pairs, WhoNeedsNoMusclesIsPassiveUnlessItIsBehindTheFront) {
  add(std::numbers::pi / measured_step, true);
  const std::vector<Refusal> refusals = verification_.refuse(everyone_, 0);
  ASSERT_EQ(refusals.size(), 1u);
  EXPECT_EQ(status(0), Status::passive);
  EXPECT_THAT(reason(0), ::testing::StartsWith("no-muscles "));
  add_honest();
  add(2 * std::numbers::pi / 3 / measured_step, true);  // half of the elongation
  EXPECT_TRUE(verification_.refuse(everyone_, 0).empty());
  EXPECT_EQ(status(2), Status::ok);
}

/// A copy is removed before selection, so that nobody would ask for its fitness; but then it must not outlive the
/// individual whose copy it is.
TEST_F(Pairs, CopiesOfTheRefusedAreRefusedToo) {
  add(exaggerated(2.6));
  add(exaggerated(2.6));
  EXPECT_EQ(verification_.refuse(everyone_, 0).size(), 2u);
  EXPECT_EQ(status(0), Status::artefact);
  EXPECT_EQ(status(1), Status::artefact);
}

TEST_F(Pairs, NobodyIsVerifiedWhoComesFromAnotherDeviceOrWithoutTheKey) {
  add(exaggerated(2.6));
  const RecordedProvenances elsewhere({1});
  EXPECT_TRUE(FrontVerification(experiment_, evaluator_, elsewhere).refuse(everyone_, 1).empty());
  experiment_.verify_front = VerifyFront::off;
  EXPECT_TRUE(verification_.refuse(everyone_, 0).empty());
  EXPECT_EQ(status(0), Status::ok);
  EXPECT_EQ(verification_.seconds(), 0);
  experiment_.verify_front = VerifyFront::trials;
  EXPECT_EQ(verification_.refuse(everyone_, 1).size(), 1u) << "older individuals are verified, too";
}

/// A device on which so many bodies are simulated.
struct BusyDevice final : testing::AlteredSimulator {
  explicit BusyDevice(std::size_t busy) : AlteredSimulator({}), bodies(busy) {}
  std::optional<DeviceUse> device_use() const override { return DeviceUse{.devices = 2, .bodies = bodies}; }
  std::size_t bodies;
};

TEST(LivesAtOnce, AreThoseThatADeviceStillHasRoomFor) {
  for (const auto& [bodies, lives] : {std::pair<std::size_t, std::size_t>{0, 200}, {150, 50}, {199, 1}, {5000, 1}}) {
    BusyDevice device(bodies);
    EXPECT_EQ(lives_at_once(device), lives);
    Experiment experiment;
    EXPECT_EQ(verified_at_once(experiment, device), std::max<std::size_t>(1, lives / 2));
    experiment.lives = 5;
    EXPECT_EQ(verified_at_once(experiment, device), std::max<std::size_t>(1, lives / 10)) << "each in all its lives";
  }
  const auto cpu = make_cpu_simulator({}, {}, 3);
  EXPECT_EQ(lives_at_once(*cpu), 3u);
}

TEST(VerifiedRun, HasNobodyOnTheFrontWhoIsMarked) {
  const testing::FinishedRun run(testing::small({"experiment.verify_front=trials", "experiment.evaluations=60"}));
  const auto expect_unmarked = [&](const Individual& one) {
    const Champion champion{{one.id, one.born, &one.genome}, one.result.objectives.at(0)};
    EXPECT_THAT(marks(verify(run.experiment, *run.simulator, {&champion, 1}).front(), true), ::testing::IsEmpty())
        << one.id;
  };
  for (const std::uint32_t id : run.archive.best(1)) expect_unmarked(run.archive.known_individual(id));
  const std::vector<Individual> population = run.archive.population();
  const auto layer = layers(population, run.experiment, run.archive.generations().back().generation);
  int on_front = 0;
  for (std::size_t i = 0; i < population.size(); ++i) {
    if (layer[i] > 0 || population[i].result.status != Status::ok) continue;
    expect_unmarked(population[i]);
    ++on_front;
  }
  EXPECT_GT(on_front, 0);
}

TEST(VerifiedRun, CountsTheRefusedAndKeepsTheirReasons) {
  const testing::FinishedRun run(testing::small({"experiment.verify_front=trials", "experiment.evaluations=60",
                                                 "materials.bone.stiffness=3e5", "simulation.unstable=run"}));
  const Archive& archive = run.archive;
  std::map<Status, std::int64_t> counted, told;
  for (std::uint32_t id = 0; id < 60; ++id) {
    const ArchivedIndividual one = archive.individual(id).value();
    ++counted[one.result.status];
    if (one.result.status != Status::artefact && one.result.status != Status::passive) continue;
    EXPECT_TRUE(one.result.objectives.empty()) << id;
    EXPECT_TRUE(archive.measures(id).empty()) << id;
    EXPECT_THAT(one.result.reason, ::testing::HasSubstr("; the run gave "));
  }
  for (const Summary& summary : archive.generations()) {
    told[Status::artefact] += summary.artefact;
    told[Status::passive] += summary.passive;
  }
  for (const Status status : {Status::artefact, Status::passive}) {
    EXPECT_GT(counted[status], 0);
    EXPECT_EQ(counted[status], told[status]);
  }
}

/// The front is verified only from the fifth generation on, when some who do not hold live already.
TEST(VerifiedRun, NewbornsAndEldersWhoAreRefusedRankBelowAllWithAFitness) {
  const testing::Scratch scratch;
  Experiment experiment = testing::small({"selection.name=elitist", "experiment.evaluations=60"});
  Archive archive = Archive::create(scratch / "run", experiment, testing::AlteredSimulator(experiment).device());
  std::map<std::uint32_t, Status> before;
  std::map<bool, int> refused, dropped;  // by whether it is an elder
  const auto follow = [&] {
    const Summary summary = archive.generations().back();
    int refused_kept = 0, ok_dropped = 0;
    for (std::uint32_t id = 0; id < summary.evaluations; ++id) {
      const ArchivedIndividual one = archive.known_individual(id);
      const bool is_refused = one.result.status == Status::artefact || one.result.status == Status::passive;
      const bool is_elder = before.contains(id), is_dropped = one.died == summary.generation;
      if (is_refused && (!is_elder || before[id] == Status::ok)) {
        EXPECT_TRUE(!one.died || is_dropped) << id << " was refused after its death";
        ++refused[is_elder];
        dropped[is_elder] += is_dropped;
      }
      refused_kept += is_refused && !one.died;
      ok_dropped += one.result.status == Status::ok && is_dropped;
      before[id] = one.result.status;
    }
    EXPECT_TRUE(refused_kept == 0 || ok_dropped == 0) << summary.generation;
  };
  for (std::size_t done = 0; !is_finished(experiment, archive.generations()); ++done) {
    experiment.verify_front = done > 3 ? VerifyFront::trials : VerifyFront::off;
    EXPECT_TRUE(done > 3 || refused.empty());
    testing::evolve_to(done + 1, experiment, archive, 2);
    follow();
  }
  for (const bool is_elder : {false, true}) {
    EXPECT_GT(refused[is_elder], 0) << is_elder;
    EXPECT_GT(dropped[is_elder], 0) << is_elder;
  }
}

TEST(VerifyFront, IsRefusedIfTheFirstObjectiveIsMeasuredWithinTheLifeOrMinimised) {
  for (const std::string name : {"name = \"early-way\"", "name = \"reach\""}) {
    const std::string target = name == "name = \"reach\"" ? "target = [1.0, 0.0, 0.0]\n" : "";
    const auto check = [&](const std::string& verify_front, const std::string& before) {
      read_experiment(testing::small_with({{before, "[[fitness]]\n" + name + "\n" + target + before},
                                           {"seed = 7", "seed = 7\nverify_front = " + verify_front}}),
                      {"test.toml", {}, {std::filesystem::path(EVODEVO_FAULTY_PLUGINS) / "special"}});
    };
    EXPECT_NO_THROW(check("'off'", "[[fitness]]"));
    EXPECT_NO_THROW(check("'trials'", "[selection]"));
    const auto is_refused =
        ::testing::ThrowsMessage<ConfigError>(testing::at_place("test.toml:", name, "verify_front", "remove"));
    EXPECT_THAT([&] { check("'trials'", "[[fitness]]"); }, is_refused);
  }
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
