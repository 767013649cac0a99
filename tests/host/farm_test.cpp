// Many ranks give the results of one, however many they are, however fast each of them is, and if some are lost.
#include "cluster/farm.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <functional>
#include <thread>

#include "cluster/ranks.hpp"
#include "evolution/evolution.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/runs.hpp"
#include "support/scratch.hpp"

namespace evodevo {
namespace {

using std::chrono::milliseconds;

/// Carries messages between ranks that are threads of this process.
class LocalChannel final : public Channel {
 public:
  /// What is on the way to each rank.
  struct Boxes {
    std::mutex mutex;
    std::vector<std::deque<Received>> of;
  };

  LocalChannel(std::shared_ptr<Boxes> boxes, int rank) : boxes_(std::move(boxes)), rank_(rank) {}

  int rank() const override { return rank_; }
  int size() const override { return static_cast<int>(boxes_->of.size()); }
  int rank_on_host() const override { return rank_; }
  int ranks_on_host() const override { return size(); }
  void send(int to, std::string bytes) override {
    const std::lock_guard lock(boxes_->mutex);
    if (!is_cut) boxes_->of[static_cast<std::size_t>(to)].push_back({rank_, std::move(bytes)});
  }
  std::optional<Received> receive() override {
    const std::lock_guard lock(boxes_->mutex);
    std::deque<Received>& box = boxes_->of[static_cast<std::size_t>(rank_)];
    if (box.empty()) return std::nullopt;
    Received received = std::move(box.front());
    box.pop_front();
    return received;
  }
  void give_up(int rank) override { given_up_.push_back(rank); }
  std::vector<int> given_up() const override { return given_up_; }
  void leave() override {}

  std::atomic<bool> is_cut = false;  ///< whether what this rank sends is lost

 private:
  std::shared_ptr<Boxes> boxes_;
  int rank_;
  std::vector<int> given_up_;
};

/// A simulator that does something else before it simulates.
class Hindered final : public Simulator {
 public:
  Hindered(const Experiment& experiment, std::function<void()> hindrance)
      : simulator_(make_cpu_simulator(experiment.scene, experiment.stepping, 1)), hindrance_(std::move(hindrance)) {}

  void run(std::span<Task> tasks, Recording recording) override {
    hindrance_();
    simulator_->run(tasks, recording);
  }
  NeighbourSearch& neighbours() override { return simulator_->neighbours(); }
  Workers& workers() override { return simulator_->workers(); }
  std::string device() const override { return simulator_->device(); }

 private:
  std::unique_ptr<Simulator> simulator_;
  std::function<void()> hindrance_;
};

/// The ranks of a run, each of which has an experiment and a simulator of its own, as processes have.
class LocalRanks {
 public:
  /// What a rank does before it simulates.
  struct Hindrance {
    int rank = -1;
    std::function<void(LocalChannel&)> act = [](LocalChannel&) {};
  };

  LocalRanks(int count, const std::vector<Override>& overrides, Hindrance hindrance) {
    auto boxes = std::make_shared<LocalChannel::Boxes>();
    boxes->of.resize(static_cast<std::size_t>(count));
    for (int rank = 0; rank < count; ++rank) {
      experiments_.push_back(testing::read(testing::small_experiment, overrides));
      channels_.push_back(std::make_unique<LocalChannel>(boxes, rank));
    }
    for (int rank = 0; rank < count; ++rank) {
      const auto at = static_cast<std::size_t>(rank);
      std::function<void()> act = [] {};
      if (rank == hindrance.rank) act = [hindrance, this, at] { hindrance.act(*channels_[at]); };
      simulators_.push_back(std::make_unique<Hindered>(experiments_[at], act));
    }
    for (std::size_t rank = 1; rank < channels_.size(); ++rank)
      threads_.emplace_back([this, rank] {
        Worker worker(experiments_[rank], *simulators_[rank]);
        channels_[rank]->send(0, message::packed(worker.hello()));
        do_jobs(*channels_[rank], worker);
      });
  }
  ~LocalRanks() { end_run(channel()); }

  const Experiment& experiment() const { return experiments_.front(); }
  Simulator& simulator() { return *simulators_.front(); }
  LocalChannel& channel() { return *channels_.front(); }

 private:
  std::vector<Experiment> experiments_;
  std::vector<std::unique_ptr<LocalChannel>> channels_;
  std::vector<std::unique_ptr<Simulator>> simulators_;
  std::vector<std::jthread> threads_;
};

/// Longer than a busy machine lets a rank wait, which sends a message every second.
constexpr std::chrono::seconds patience{6};

class FarmRuns : public ::testing::Test {
 protected:
  using Hindrance = LocalRanks::Hindrance;

  /// Makes a run in the folder `name` with several ranks.
  Archive run(const std::string& name, int count, const std::vector<Override>& overrides, Hindrance hindrance = {}) {
    LocalRanks ranks(count, overrides, hindrance);
    Archive archive = Archive::create(scratch_ / name, ranks.experiment(), ranks.simulator().device());
    Farm farm(ranks.experiment(), ranks.simulator(), ranks.channel(), {}, patience);
    evolve(ranks.experiment(), farm, archive, stop_, Observer{});
    shares_ = farm.shares();
    given_up_ = ranks.channel().given_up();
    return archive;
  }
  /// Makes the same run in one process.
  Archive run_alone(const std::vector<Override>& overrides) {
    const Experiment experiment = testing::read(testing::small_experiment, overrides);
    const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
    Archive archive = Archive::create(scratch_ / "alone", experiment, simulator->device());
    evolve(experiment, *simulator, archive, stop_, Observer{});
    return archive;
  }

  testing::Scratch scratch_;
  std::atomic<bool> stop_ = false;
  std::vector<Share> shares_;
  std::vector<int> given_up_;
};

const std::vector<Override> many{{"experiment.evaluations", "60", ""}, {"experiment.population", "20", ""}};

TEST_F(FarmRuns, GiveTheSameForAnyNumberOfRanks) {
  const Archive alone = run_alone(many);
  for (const int count : {1, 2, 5}) {
    testing::expect_same_runs(alone, run(std::to_string(count), count, many));
    std::uint64_t lives = 0;
    for (const Share& share : shares_) lives += share.lives;
    EXPECT_EQ(lives, 60u);
    EXPECT_EQ(shares_.size(), static_cast<std::size_t>(count));
  }
}

TEST_F(FarmRuns, OfMoreRanksThanRobotsGiveTheSame) {
  const std::vector<Override> few{{"experiment.evaluations", "8", ""}, {"experiment.population", "3", ""}};
  testing::expect_same_runs(run_alone(few), run("many", 16, few));
}

TEST_F(FarmRuns, VerifyTheFrontAlike) {
  std::vector<Override> verified = many;
  verified.push_back({"experiment.verify_front", "true", ""});
  verified.push_back({"materials.bone.stiffness", "3e5", ""});
  verified.push_back({"simulation.unstable", "run", ""});
  const Archive alone = run_alone(verified);
  std::int64_t refused = 0;
  for (const Summary& summary : alone.generations()) refused += summary.artefact + summary.passive;
  EXPECT_GT(refused, 0);
  testing::expect_same_runs(alone, run("three", 3, verified));
}

TEST_F(FarmRuns, WithASlowRankGiveTheSame) {
  testing::expect_same_runs(
      run_alone(many),
      run("slow", 3, many, {2, [](LocalChannel&) { std::this_thread::sleep_for(milliseconds(100)); }}));
  EXPECT_THAT(given_up_, ::testing::IsEmpty());
}

TEST_F(FarmRuns, GoOnWithoutARankThatFallsSilent) {
  ::testing::internal::CaptureStderr();
  const Archive without = run("silent", 3, many, {1, [](LocalChannel& channel) { channel.is_cut = true; }});
  EXPECT_THAT(::testing::internal::GetCapturedStderr(),
              testing::at_place("warning: rank 1 on ", " 6 s ", "other ranks"));
  testing::expect_same_runs(run_alone(many), without);
  EXPECT_THAT(given_up_, ::testing::ElementsAre(1));
  EXPECT_TRUE(shares_[1].lost);
  EXPECT_EQ(shares_[1].lives, 0u);
}

TEST_F(FarmRuns, EndWithTheNameOfARankWhoseJobFails) {
  const auto fail = [](LocalChannel&) { throw std::runtime_error("the GPU is lost"); };
  try {
    run("failed", 3, many, {2, fail});
    FAIL() << "the run goes on";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::at_place("rank 2 on ", ": the GPU is lost"));
  }
}

TEST_F(FarmRuns, ForgiveSilenceInWhichTheLeaderDoesNotListen) {
  LocalRanks ranks(2, many, {});
  Archive archive = Archive::create(scratch_ / "run", ranks.experiment(), ranks.simulator().device());
  Farm farm(ranks.experiment(), ranks.simulator(), ranks.channel(), {}, std::chrono::seconds(3));
  int generations = 0;
  const auto pause = [&](const Summary&) {
    std::this_thread::sleep_for(std::chrono::seconds(4));
    stop_ = ++generations == 2;
  };
  evolve(ranks.experiment(), farm, archive, stop_, {.generation_done = pause});
  EXPECT_EQ(generations, 2);
  EXPECT_THAT(ranks.channel().given_up(), ::testing::IsEmpty());
}

TEST_F(FarmRuns, EndWithTheNameOfARankThatDoesNotFit) {
  const Experiment experiment = testing::read(testing::small_experiment);
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
  const auto boxes = std::make_shared<LocalChannel::Boxes>();
  boxes->of.resize(2);
  LocalChannel leader(boxes, 0), other(boxes, 1);
  const auto refusal = [&](const std::string& bytes) {
    other.send(0, bytes);
    try {
      const Farm farm(experiment, *simulator, leader, {}, patience);
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string("no message");
  };
  EXPECT_THAT(refusal(message::packed(message::Failure{"node7", "no operator \"x\"", true})),
              testing::at_place("rank 1 on node7", "no operator \"x\"", ""));
  message::Hello hello = Worker(experiment, *simulator).hello();
  hello.host = "node8";
  const auto altered = [&](auto change) {
    message::Hello changed = hello;
    change(changed);
    return refusal(message::packed(changed));
  };
  EXPECT_THAT(altered([](message::Hello& h) { h.program = "abc"; }),
              testing::at_place("rank 1 on node8", "abc", "give all ranks the same program"));
  EXPECT_THAT(altered([](message::Hello& h) { h.provenance.device = "cuda, X"; }),
              testing::at_place("rank 1 on node8", "cuda, X", "--device"));
  EXPECT_THAT(altered([](message::Hello& h) { h.provenance.operators.back().hash = "def"; }),
              testing::at_place("rank 1 on node8", "def", "give all ranks the same libraries"));
}

TEST(JobSize, ShrinksTowardsTheEndAndIsNeverNothing) {
  EXPECT_EQ(job_size(10'000, 32, 100), 100u);
  EXPECT_EQ(job_size(3'200, 32, 100), 50u);
  EXPECT_EQ(job_size(100, 32, 100), 25u) << "fewer would leave a GPU idle";
  EXPECT_EQ(job_size(3, 32, 100), 3u);
  EXPECT_EQ(job_size(1, 1, 1), 1u);
  EXPECT_EQ(job_size(0, 4, 8), 0u);
}

TEST(ShareOf, DividesEquallyOrShares) {
  using ::testing::ElementsAre;
  EXPECT_THAT(share_of(8, 0, 2), ElementsAre(0, 2, 4, 6));
  EXPECT_THAT(share_of(8, 1, 2), ElementsAre(1, 3, 5, 7));
  EXPECT_THAT(share_of(3, 0, 2), ElementsAre(0)) << "otherwise one sharer would be twice as fast";
  EXPECT_THAT(share_of(2, 3, 4), ElementsAre(1));
  EXPECT_THAT(share_of(1, 5, 8), ElementsAre(0));
  EXPECT_THAT(share_of(0, 0, 2), ::testing::IsEmpty());
}

}  // namespace
}  // namespace evodevo
