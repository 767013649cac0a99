// Many ranks give the results of one, however many they are, however fast each of them is, and if some are lost.
#include "cluster/farm.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <functional>
#include <map>
#include <set>
#include <thread>

#include "cluster/groups.hpp"
#include "cluster/ranks.hpp"
#include "cluster/wire.hpp"
#include "evolution/breeding.hpp"
#include "evolution/evolution.hpp"
#include "operators/loader.hpp"
#include "support/experiments.hpp"
#include "support/lives.hpp"
#include "support/local_channel.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"
#include "support/runs.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

using testing::at_place;
using ::testing::ThrowsMessage;

using testing::LocalChannel;

/// A simulator that does something else before it simulates, and may have another name.
struct Hindered final : testing::AlteredSimulator {
  Hindered(const Experiment& experiment, std::function<void()> before, bool other)
      : AlteredSimulator(experiment), hindrance(std::move(before)), is_strange(other) {}
  void run(std::span<Task> tasks, Recording recording) override {
    hindrance();
    AlteredSimulator::run(tasks, recording);
  }
  std::string device() const override { return is_strange ? "strange" : AlteredSimulator::device(); }

  std::function<void()> hindrance;
  bool is_strange;
};

/// The ranks of a run, each of which has an experiment and a simulator of its own, as processes have.
class LocalRanks {
 public:
  /// What a rank does before it simulates.
  struct Hindrance {
    int rank = -1;
    std::function<void(LocalChannel&)> act = [](LocalChannel&) {};
  };

  /// The ranks in `strange` have another device, and stronger gravity: nobody can mistake their results for others.
  LocalRanks(int count, const std::vector<std::string>& values, Hindrance hindrance, std::set<int> strange = {}) {
    const auto boxes = std::make_shared<LocalChannel::Boxes>(count);
    for (int rank = 0; rank < count; ++rank) {
      const bool is_strange = strange.contains(rank);
      std::vector<std::string> own = values;
      if (is_strange) own.push_back("scene.gravity.acceleration=11");
      experiments_.push_back(testing::small(own));
      channels_.push_back(std::make_unique<LocalChannel>(boxes, rank));
      std::function<void()> act = [] {};
      if (rank == hindrance.rank) act = [act = hindrance.act, channel = channels_.back().get()] { act(*channel); };
      simulators_.push_back(std::make_unique<Hindered>(experiments_.back(), act, is_strange));
    }
    for (std::size_t rank = 1; rank < channels_.size(); ++rank)
      threads_.emplace_back([this, rank] {
        Worker worker(experiments_[rank], *simulators_[rank]);
        channels_[rank]->send(0, message::packed(worker.hello()));
        do_jobs(*channels_[rank], worker);
      });
  }
  ~LocalRanks() { end_run(channel()); }

  const Experiment& experiment(std::size_t rank = 0) const { return experiments_[rank]; }
  Simulator& simulator(std::size_t rank = 0) { return *simulators_[rank]; }
  LocalChannel& channel(std::size_t rank = 0) { return *channels_[rank]; }

 private:
  std::deque<Experiment> experiments_;
  std::vector<std::unique_ptr<LocalChannel>> channels_;
  std::vector<std::unique_ptr<Simulator>> simulators_;
  std::vector<std::jthread> threads_;
};

/// Longer than a busy machine lets a rank wait, which sends a message every second.
constexpr std::chrono::seconds patience{6};

class FarmRuns : public ::testing::Test {
 protected:
  using Hindrance = LocalRanks::Hindrance;

  /// Makes a run in the folder `name` with these ranks.
  Archive run(const std::string& name, LocalRanks& ranks, const FarmOptions& options, const Observer& observer = {}) {
    Archive archive = Archive::create(scratch_ / name, ranks.experiment(), ranks.simulator().device());
    Farm farm(ranks.experiment(), ranks.simulator(), ranks.channel(), {}, options);
    evolve(ranks.experiment(), farm, archive, stop_, observer);
    shares_ = farm.shares();
    given_up_ = ranks.channel().given_up();
    return archive;
  }
  Archive run(const std::string& name, int count, const std::vector<std::string>& values, Hindrance hindrance = {}) {
    LocalRanks ranks(count, values, hindrance);
    return run(name, ranks, {.patience = patience});
  }

  testing::Scratch scratch_;
  std::atomic<bool> stop_ = false;
  std::vector<Share> shares_;
  std::vector<int> given_up_;
};

const std::vector<std::string> many{"experiment.evaluations=60", "experiment.population=20"};

/// Settings with which some individuals come to the front whose fitness does not hold.
const std::vector<std::string> verified{many[0], many[1], "experiment.verify_front=trials",
                                        "materials.bone.stiffness=3e5", "simulation.unstable=run"};

/// The number of individuals that were not evaluated, because there was one of the same genome and blocks: a newborn
/// before them in their generation, or a member of the population that had a fitness.
std::uint64_t twins_in(const Archive& archive) {
  std::vector<ArchivedIndividual> all;
  std::uint64_t twins = 0;
  for (std::uint32_t id = 0; const auto one = archive.individual(id); ++id) {
    twins += std::ranges::any_of(all, [&](const ArchivedIndividual& other) {
      const bool is_member = other.result.status == Status::ok && (!other.died || *other.died >= one->born);
      return other.genome == one->genome && (other.born == one->born || is_member);
    });
    all.push_back(*one);
  }
  return twins;
}

TEST_F(FarmRuns, GiveTheSameForAnyNumberOfRanksHoweverFastTheyAre) {
  const testing::FinishedRun alone(testing::small(many));
  for (const int count : {1, 2, 5, 64}) {
    testing::expect_same_runs(alone.archive, run(std::to_string(count), count, many));
    std::uint64_t robots = 0;
    for (const Share& share : shares_) robots += share.robots;
    EXPECT_EQ(robots + twins_in(alone.archive), 60u);
    EXPECT_EQ(shares_.size(), static_cast<std::size_t>(count));
  }
  const auto wait = [](LocalChannel&) { std::this_thread::sleep_for(std::chrono::milliseconds(100)); };
  testing::expect_same_runs(alone.archive, run("slow", 3, many, {2, wait}));
  EXPECT_THAT(given_up_, ::testing::IsEmpty());
}

TEST_F(FarmRuns, VerifyTheFrontAlike) {
  const testing::FinishedRun alone(testing::small(verified));
  std::int64_t refused = 0;
  for (const Summary& summary : alone.archive.generations()) refused += summary.refused();
  EXPECT_GT(refused, 0);
  testing::expect_same_runs(alone.archive, run("three", 3, verified));
}

TEST_F(FarmRuns, GoOnWithoutARankThatFallsSilent) {
  ::testing::internal::CaptureStderr();
  const Archive without = run("silent", 3, many, {1, [](LocalChannel& channel) { channel.is_cut = true; }});
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), at_place("warning: rank 1 on ", " 6 s ", "other ranks"));
  testing::expect_same_runs(testing::FinishedRun(testing::small(many)).archive, without);
  EXPECT_THAT(given_up_, ::testing::ElementsAre(1));
  EXPECT_TRUE(shares_[1].lost);
  EXPECT_EQ(shares_[1].robots, 0u);
}

TEST_F(FarmRuns, EndWithTheNameOfARankWhoseJobFails) {
  const auto fail = [](LocalChannel&) { throw std::runtime_error("the GPU is lost"); };
  EXPECT_THAT(
      [&] {
        run("failed", 3, many, {2, fail});
      },
      ThrowsMessage<std::runtime_error>(at_place("rank 2 on ", ": the GPU is lost")));
}

TEST_F(FarmRuns, ForgiveSilenceInWhichTheLeaderDoesNotListen) {
  LocalRanks ranks(2, many, {});
  int generations = 0;
  const auto pause = [&](std::int64_t, const Summary&) {
    std::this_thread::sleep_for(std::chrono::seconds(4));
    stop_ = ++generations == 2;
  };
  run("run", ranks, {.patience = std::chrono::seconds(3)}, {.generation_done = pause});
  EXPECT_EQ(generations, 2);
  EXPECT_THAT(given_up_, ::testing::IsEmpty());
}

TEST_F(FarmRuns, OfMixedRanksKeepWhatEachOfThemFinds) {
  LocalRanks ranks(3, verified, {}, {1, 2});
  const Archive archive = run("run", ranks, {.mixed = true, .patience = patience});
  ASSERT_EQ(archive.provenances().size(), 2u);
  EXPECT_EQ(archive.provenances()[1].device, "strange");
  int recorded = 0, refused = 0;
  std::map<std::uint32_t, int> scored;
  for (std::uint32_t id = 0; id < 60; ++id) {
    const ArchivedIndividual one = archive.individual(id).value();
    const std::size_t rank = one.provenance;  // 1 and 2 are alike
    LocalEvaluator again(ranks.experiment(rank), ranks.simulator(rank));
    const Newborn newborn{one.id, one.born, &one.genome};
    const Result result = again.evaluate({&newborn, 1}, [](double) {}).front().result;
    if (const std::vector<LifeRecord> lives = archive.lives(id); !lives.empty()) {
      EXPECT_EQ(lives, again.records({&newborn, 1}, std::vector{0u}).front()) << id;
      ++recorded;
    }
    if (one.result.status == Status::artefact || one.result.status == Status::passive) {
      const Champion champion{newborn, result.objectives.at(0)};
      const std::optional<Mark> mark = first_mark(again.verify({&champion, 1}, std::vector{0u}).front(), true);
      EXPECT_THAT(one.result.reason, at_place(mark.value().trial.name)) << id << ", by rank " << rank;
      ++refused;
    } else {
      EXPECT_EQ(one.result.objectives, result.objectives) << id << ", by rank " << rank;
      scored[one.provenance] += one.result.status == Status::ok;
    }
  }
  EXPECT_GT(std::min({scored[0], scored[1], recorded, refused}), 0);
}

TEST_F(FarmRuns, OfMixedRanksLetNobodyLiveAgain) {
  LocalRanks ranks(2, {many[0], many[1], "experiment.birth_noise=0.01", "selection.remeasure=1"}, {}, {1});
  EXPECT_THAT(testing::refusal<InputError>([&] {
                Farm(ranks.experiment(), ranks.simulator(), ranks.channel(), {}, {.mixed = true, .patience = patience});
              }),
              testing::naming("--mixed", "selection.remeasure = 1"));
}

TEST_F(FarmRuns, OfMixedRanksAskThoseThatCanRepeatALifeAndEndWhenNoneIsLeft) {
  LocalRanks ranks(3, many, {}, {1});
  Farm farm(ranks.experiment(), ranks.simulator(), ranks.channel(), {}, {.mixed = true, .patience = patience});
  const std::vector<Individual> individuals = breed(ranks.experiment(), {}, 0, 0, 6);
  std::vector<Champion> champions;
  std::vector<std::uint32_t> provenances;
  for (const Individual& one : individuals) {
    champions.push_back({{one.id, one.born, &one.genome}, 1});
    provenances.push_back(one.id % 2);
  }
  const std::vector<Verification> found = farm.verify(champions, provenances);
  std::size_t differ = 0;
  for (std::size_t i = 0; i < champions.size(); ++i) {
    const auto value = [&](std::size_t rank) {
      LocalEvaluator alone(ranks.experiment(rank), ranks.simulator(rank));
      return alone.verify({&champions[i], 1}, std::vector{0u}).front().trials.front().value;
    };
    EXPECT_EQ(found[i].trials.front().value, value(provenances[i])) << i;
    differ += value(0) != value(1);
  }
  EXPECT_GT(differ, 3u) << "nobody could tell who has verified them";
  ranks.channel(1).is_cut = true;
  const Newborn& newborn = champions.front().newborn;
  const auto ends = ThrowsMessage<std::runtime_error>(testing::naming("strange", "resume"));
  EXPECT_THAT([&] { farm.records({&newborn, 1}, std::vector{1u}); }, ends);
  EXPECT_THAT([&] { farm.verify({&champions.front(), 1}, std::vector{1u}); }, ends);
}

/// Two ranks that send what a test says, and what they need to work. The leader's number in the run is `first`.
struct TwoRanks {
  explicit TwoRanks(int first = 0) : boxes(std::make_shared<LocalChannel::Boxes>(first + 2)), leader(boxes, first) {}

  std::shared_ptr<LocalChannel::Boxes> boxes;
  LocalChannel leader, other{boxes, leader.rank() + 1};
  Experiment experiment = testing::small();
  std::unique_ptr<Simulator> simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 1);
  Worker worker{experiment, *simulator};
};

TEST(Farm, EndsWithTheNameOfARankThatDoesNotFit) {
  TwoRanks two;
  const auto refusal = [&](const std::string& bytes, bool mixed) {
    two.other.send(0, bytes);
    return testing::refusal<std::runtime_error>([&] {
      const Farm farm(two.experiment, *two.simulator, two.leader, {}, {.mixed = mixed, .patience = patience});
    });
  };
  EXPECT_THAT(refusal(message::packed(message::Failure{"node7", "no operator \"x\"", true}), false),
              at_place("rank 1 on node7", "no operator \"x\"", ""));
  const auto altered = [&](void (*change)(message::Hello&), bool mixed) {
    message::Hello hello = two.worker.hello();
    hello.host = "node8";
    change(hello);
    return refusal(message::packed(hello), mixed);
  };
  const struct {
    void (*change)(message::Hello&);
    const char *named, *remedy;
  } builds[] = {{[](message::Hello& h) { h.provenance.program = "abc"; }, "abc", "the same program"},
                {[](message::Hello& h) { h.provenance.device = "cuda, X"; }, "cuda, X", "--device"},
                {[](message::Hello& h) { h.provenance.operators.back().hash = "def"; }, "def", "the same libraries"}};
  for (const auto& [change, named, remedy] : builds) {
    EXPECT_THAT(altered(change, false), at_place("rank 1 on node8", named, remedy, "--mixed"));
    EXPECT_EQ(altered(change, true), "no refusal");
  }
  EXPECT_THAT(altered([](message::Hello& h) { h.layout.types.front().genes.front().high += 1; }, true),
              testing::naming("rank 1 on node8", "layout", "same version"));
  EXPECT_THAT(altered([](message::Hello& h) { h.scores.front() += " or so"; }, true),
              testing::naming("rank 1 on node8", "score", "same version"));
}

TEST(Farm, NamesRanksOfAGroupByTheirNumbersInTheRun) {
  TwoRanks two(2);
  GroupChannel group(two.leader, {2, 3});
  message::Hello hello = two.worker.hello();
  hello.provenance.program = "abc";
  two.other.send(2, message::packed(hello));
  EXPECT_THAT([&] { const Farm farm(two.experiment, *two.simulator, group, {}, {.patience = patience}); },
              ThrowsMessage<InputError>(testing::naming("rank 3 on ", "abc", "than rank 2 on ")));
}

TEST(DoJobs, TellsTheLeaderOfAJobThatCannotBeRead) {
  TwoRanks two;
  std::string job = message::packed(message::Job{});
  job.pop_back();
  two.leader.send(1, job);
  end_run(two.leader);
  do_jobs(two.other, two.worker, patience);
  EXPECT_NE(message::unpacked<message::Failure>(two.leader.receive().value().bytes).reason, "");
}

TEST(Serve, RefusesAnotherProtocol) {
  TwoRanks two;
  two.leader.send(1, message::packed(message::Setup{.protocol = "2.99"}));
  end_run(two.leader);
  serve(two.other, first_message(two.other).value(), [] { return RankOptions(); });
  EXPECT_THAT(message::unpacked<message::Failure>(two.leader.receive().value().bytes).reason,
              testing::naming("protocol " + message::protocol(), "protocol 2.99", "same version"));
}

TEST(Messages, EndWhereTheirContentEnds) {
  const std::string bytes = message::packed(message::Failure{.reason = "no room"});
  EXPECT_EQ(message::unpacked<message::Failure>(bytes).reason, "no room");
  EXPECT_THROW(message::unpacked<message::Failure>(bytes + '\0'), WireError);
  EXPECT_THROW(message::unpacked<message::Failure>(bytes.substr(0, bytes.size() - 1)), WireError);
}

/// Other builds of the program read messages as long as the protocol is the same.
TEST(Messages, AreThoseOfTheirProtocol) {
  Genome genome{0.5F, -1};
  genome.blocks = {{1, 2, 3, 4}};
  Layout layout;
  layout.types = {{"cell", {{-1, 1, 2, 3}}, 4, 5, {"fate"}, 6}};
  layout.first_blocks = genome.blocks;
  layout.own = 7;
  const message::Outcome outcome{{Status::diverged, "why", 1, {2}, 5, {}, {3}, {{24, 17, 18, 19, 4}}, {{25}}},
                                 {"record"},
                                 {8, 0.25, {{"again", Status::ok, "so", 0.125}}}};
  const Provenance provenance{
      "device", "version", "program", {{"fitness", "way", "1", "file", "hash", nullptr, "label"}}};
  const std::string bytes = message::packed(message::Setup{"protocol", "text", "name", {{"path", "content"}}, true}) +
                            message::packed(message::Hello{"host", provenance, layout, {"more way in m"}, 9, 10, 11}) +
                            message::packed(message::Job{12, message::Work::verify, {{13, 14, 26, 27, 0.5, genome}}}) +
                            message::packed(message::Answer{15, {outcome}, 0.75}) +
                            message::packed(message::Beat{0.1, 0.2}) + message::packed(message::End{{16}}) +
                            message::packed(message::Failure{"host", "reason", true}) +
                            message::packed(message::Kind::forget);
  const testing::Scratch scratch;
  EXPECT_EQ(message::protocol() + ": " + file_hash(scratch.write("messages", bytes)), "3.17: f9d80c046c556ead")
      << "a message has changed: increase message::protocol() unless the archive's format has grown, and put what this "
         "test says here";
}

TEST(JobSize, ShrinksTowardsTheEndAndGivesEachRankSomeOfASmallBatch) {
  const message::Hello gpu{.jobs = 16, .robots = 64}, cpu{.jobs = 2, .robots = 8};
  EXPECT_EQ(job_size(100'000, 32, 50'000, gpu), 256u);
  EXPECT_EQ(job_size(6'400, 32, 50'000, gpu), 100u);
  EXPECT_EQ(job_size(640, 32, 50'000, gpu), 64u) << "fewer would leave a GPU idle";
  EXPECT_EQ(job_size(3, 32, 50'000, gpu), 3u);
  EXPECT_EQ(job_size(0, 32, 50'000, gpu), 0u);
  EXPECT_EQ(job_size(200, 64, 50, gpu), 12u) << "a fourth of its share for each of four jobs";
  EXPECT_EQ(job_size(80, 64, 20, gpu), 12u) << "fewer would not repay a batch";
  EXPECT_EQ(job_size(31, 64, 8, gpu), 8u);
  EXPECT_EQ(job_size(1'000, 8, 250, cpu), 32u);
  EXPECT_EQ(job_size(31, 8, 8, cpu), 8u) << "one for each thread";
  EXPECT_EQ(job_size(7, 8, 2, cpu), 2u);
  EXPECT_EQ(job_size(1, 2, 1, {}), 1u);
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
}  // namespace evodevo::EVODEVO_FILE
