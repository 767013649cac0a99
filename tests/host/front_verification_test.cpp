// Verification before the front: who does not hold loses the fitness, and who comes to the front instead is verified
// too.
#include "evolution/front_verification.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <map>
#include <numbers>

#include "evolution/evolution.hpp"
#include "evolution/selection_table.hpp"
#include "support/experiments.hpp"
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
    const std::vector<Newborn> newborns{{one.id, 0, &one.genome}};
    one.result = Evaluation(experiment_, *simulator_).evaluate(newborns, [](double) {}).front();
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

TEST_F(Pairs, WhoHoldsStaysOk) {
  EXPECT_NEAR(add_honest(), strain, 1e-3);
  EXPECT_TRUE(verification_.refuse(everyone_, 0).empty());
  EXPECT_EQ(status(0), Status::ok) << reason(0);
}

TEST_F(Pairs, TheNextInLineAreVerifiedWhenTheFirstFall) {
  ASSERT_GT(add_honest(), 0.05);
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

TEST_F(Pairs, WhoNeedsNoMusclesIsPassive) {
  add(std::numbers::pi / measured_step, true);
  const std::vector<Refusal> refusals = verification_.refuse(everyone_, 0);
  ASSERT_EQ(refusals.size(), 1u);
  EXPECT_EQ(status(0), Status::passive);
  EXPECT_THAT(reason(0), ::testing::StartsWith("no-muscles "));
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

TEST_F(Pairs, WhoIsBehindTheFrontIsNotVerified) {
  add_honest();
  add(2 * std::numbers::pi / 3 / measured_step, true);  // half of the elongation
  EXPECT_TRUE(verification_.refuse(everyone_, 0).empty());
  EXPECT_EQ(status(1), Status::ok);
}

TEST_F(Pairs, WithoutTheKeyNobodyIsVerified) {
  add(exaggerated(2.6));
  experiment_.verify_front = false;
  EXPECT_TRUE(verification_.refuse(everyone_, 0).empty());
  EXPECT_EQ(status(0), Status::ok);
  EXPECT_EQ(verification_.seconds(), 0);
}

TEST_F(Pairs, WhoComesFromAnotherDeviceIsNotVerified) {
  add(exaggerated(2.6));
  const RecordedProvenances elsewhere({1});
  FrontVerification there(experiment_, evaluator_, elsewhere);
  EXPECT_TRUE(there.refuse(everyone_, 1).empty());
  EXPECT_EQ(verification_.refuse(everyone_, 1).size(), 1u) << "older individuals are verified, too";
}

/// A device on which so many bodies are simulated.
class BusyDevice final : public Simulator {
 public:
  explicit BusyDevice(std::size_t bodies) : bodies_(bodies) {}
  void run(std::span<Task>, Recording) override {}
  NeighbourSearch& neighbours() override { throw std::logic_error("not used"); }
  Workers& workers() override { return workers_; }
  std::optional<DeviceUse> device_use() const override { return DeviceUse{.devices = 2, .bodies = bodies_}; }
  std::string device() const override { return "device"; }

 private:
  std::size_t bodies_;
  Workers workers_{1};
};

TEST(LivesAtOnce, AreThoseThatADeviceStillHasRoomFor) {
  for (const auto& [bodies, lives] : {std::pair<std::size_t, std::size_t>{0, 200}, {150, 50}, {199, 1}, {5000, 1}}) {
    BusyDevice device(bodies);
    EXPECT_EQ(lives_at_once(device), lives);
    EXPECT_EQ(verified_at_once(device), std::max<std::size_t>(1, lives / 2));
  }
  const auto cpu = make_cpu_simulator({}, {}, 3);
  EXPECT_EQ(lives_at_once(*cpu), 3u);
}

class VerifiedRun : public ::testing::Test {
 protected:
  /// Returns the archive of a run that verifies its front.
  Archive run(const std::string& folder, std::vector<Override> overrides = {}) {
    overrides.push_back({"experiment.verify_front", "true", ""});
    overrides.push_back({"experiment.evaluations", "60", ""});
    experiment_.emplace(testing::read(testing::small_experiment, overrides));
    simulator_ = make_cpu_simulator(experiment_->scene, experiment_->stepping, 2);
    Archive archive = Archive::create(scratch_ / folder, *experiment_, simulator_->device());
    const std::atomic<bool> stop = false;
    evolve(*experiment_, *simulator_, archive, stop, Observer{});
    return archive;
  }
  std::vector<std::string> marks_of(const Individual& one) {
    const Champion champion{{one.id, one.born, &one.genome}, one.result.objectives.at(0)};
    return marks(verify(*experiment_, *simulator_, {&champion, 1}).front(), true);
  }

  testing::Scratch scratch_;
  std::optional<Experiment> experiment_;
  std::unique_ptr<Simulator> simulator_;
};

TEST_F(VerifiedRun, NobodyOnTheFrontIsMarked) {
  const Archive archive = run("run");
  const std::vector<Individual> population = archive.population();
  const std::vector<std::uint32_t> layer = layers(population, *experiment_, archive.generations().back().generation);
  for (const std::uint32_t id : archive.best(1))
    EXPECT_THAT(marks_of(archive.known_individual(id)), ::testing::IsEmpty()) << id;
  for (std::size_t i = 0; i < population.size(); ++i) {
    if (layer[i] > 0 || population[i].result.status != Status::ok) continue;
    EXPECT_THAT(marks_of(population[i]), ::testing::IsEmpty()) << population[i].id;
  }
}

TEST_F(VerifiedRun, CountsTheRefusedAndKeepsTheirReasons) {
  const Archive archive = run("run", {{"materials.bone.stiffness", "3e5", ""}, {"simulation.unstable", "run", ""}});
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
  EXPECT_GT(counted[Status::artefact], 0);
  EXPECT_GT(counted[Status::passive], 0);
  EXPECT_EQ(counted[Status::artefact], told[Status::artefact]);
  EXPECT_EQ(counted[Status::passive], told[Status::passive]);
}

/// The front is verified only from the fifth generation on, when some who do not hold live already.
TEST_F(VerifiedRun, NewbornsAndEldersWhoAreRefusedRankBelowAllWithAFitness) {
  Experiment experiment = testing::read(testing::small_experiment, {{"selection.name", "elitist", ""}});
  experiment.evaluations = 60;
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 2);
  Archive archive = Archive::create(scratch_ / "run", experiment, simulator->device());
  std::atomic<bool> stop = false;
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
  const Observer observer{.generation_done = [&](const Summary&) { stop = true; }};
  for (; !is_finished(experiment, archive.generations()); stop = false) {
    experiment.verify_front = archive.generations().size() > 3;
    if (!experiment.verify_front) {
      EXPECT_TRUE(refused.empty());
    }
    evolve(experiment, *simulator, archive, stop, observer);
    follow();
  }
  for (const bool is_elder : {false, true}) {
    EXPECT_GT(refused[is_elder], 0) << is_elder;
    EXPECT_GT(dropped[is_elder], 0) << is_elder;
  }
}

TEST(VerifyFront, IsRefusedIfTheFirstObjectiveIsMeasuredWithinTheLife) {
  const auto check = [](const std::string& verify_front, const std::string& early) {
    std::string text = testing::small_experiment;
    text.replace(text.find("[experiment]"), 12, "[experiment]\nverify_front = " + verify_front);
    const std::string fitness = "[[fitness]]\nname = \"early-way\"\n";
    text.insert(early == "first" ? text.find("[[fitness]]") : text.find("[selection]"), fitness);
    read_experiment(text, {"test.toml", {}, {std::filesystem::path(EVODEVO_FAULTY_PLUGINS) / "special"}});
  };
  EXPECT_NO_THROW(check("false", "first"));
  EXPECT_NO_THROW(check("true", "last"));
  try {
    check("true", "first");
    FAIL() << "it must not be accepted";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), testing::at_place("test.toml:", "name = \"early-way\"", "verify_front = true", "remove"));
  }
}

TEST(VerifyFront, IsRefusedIfTheFirstObjectiveIsMinimised) {
  const auto check = [](const std::string& verify_front, const char* before) {
    std::string text = testing::small_experiment;
    text.insert(text.find(before), "[[fitness]]\nname = \"reach\"\ntarget = [1.0, 0.0, 0.0]\n");
    text.replace(text.find("[experiment]"), 12, "[experiment]\nverify_front = " + verify_front);
    read_experiment(text, {"test.toml", {}, {}});
  };
  EXPECT_NO_THROW(check("false", "[[fitness]]"));
  EXPECT_NO_THROW(check("true", "[selection]"));
  try {
    check("true", "[[fitness]]");
    FAIL() << "it must not be accepted";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), testing::at_place("test.toml:", "name = \"reach\"", "verify_front = true", "remove"));
  }
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
