// Runs whose islands several ranks evolve. The ranks are threads of this process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <optional>
#include <thread>

#include "engine/run.hpp"
#include "support/islands.hpp"
#include "support/local_channel.hpp"
#include "support/messages.hpp"
#include "support/refusals.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using testing::LocalChannel;
using testing::naming;

class IslandRanks : public ::testing::Test {
 protected:
  using Watch = std::function<void(std::int64_t island, const Summary& summary)>;

  std::vector<Experiment> read() const { return testing::read_islands(scratch_, testing::small_islands); }

  /// Begins the run in a folder, or goes on with it, with so many ranks. `others` says what the others are told of it.
  void run(
      const std::string& folder, int count, const Watch& watch,
      const std::function<RunSpec()>& others = [] { return RunSpec(); }) {
    const auto boxes = std::make_shared<LocalChannel::Boxes>(count);
    std::vector<std::jthread> threads;
    for (int rank = 1; rank < count; ++rank)
      threads.emplace_back([&others, boxes, rank] {
        LocalChannel channel(boxes, rank);
        evodevo::Run::serve(channel, others);
      });
    LocalChannel channel(boxes, 0);
    struct Ending {  // as that of Ranks
      Channel& channel;
      ~Ending() { end_run(channel); }
    } const ending{channel};
    std::atomic<bool> stop = false;
    const RunSpec spec{.folder = scratch_ / folder, .ranks = &channel, .stop = &stop};
    auto run = has_islands(spec.folder) ? evodevo::Run::open(spec) : evodevo::Run::begin(read(), spec);
    if (watch) run.observe({.generation_done = watch});
    try {
      while (run.advance()) {
      }
      run.finish();
    } catch (const std::exception&) {
      known_ = run.archives().size();
      EXPECT_FALSE(run.advance());
      EXPECT_FALSE(run.is_finished());
      throw;
    }
    EXPECT_TRUE(run.is_complete());
  }
  void go_on(const std::string& folder) {
    run(folder, 3, {});
    testing::evolve_islands(read(), scratch_ / "alone", 2);
    testing::expect_same_islands(scratch_ / "alone", scratch_ / folder);
  }

  testing::Scratch scratch_;
  std::optional<std::size_t> known_;  ///< number of archives of a run that has failed
};

TEST_F(IslandRanks, MakeTheRunOfOneProcessAndTellOfAllIslands) {
  testing::evolve_islands(read(), scratch_ / "alone", 2);
  for (const int count : {2, 3, 4}) {
    std::map<std::int64_t, std::uint32_t> next;
    run(std::to_string(count), count,
        [&](std::int64_t island, const Summary& summary) { EXPECT_EQ(next[island]++, summary.generation); });
    EXPECT_THAT(next, ::testing::ElementsAre(std::pair(1, 7u), std::pair(2, 7u), std::pair(3, 7u)));
    testing::expect_same_islands(scratch_ / "alone", scratch_ / std::to_string(count));
  }
}

TEST_F(IslandRanks, EndTogetherIfTheClientFailsAndAnyNumberOfThemGoesOn) {
  for (const std::int64_t of : {1, 3}) {  // of a group of rank 0, and of another one
    const auto fail = [&](std::int64_t island, const Summary& summary) {
      if (island == of && summary.generation == 2) throw std::runtime_error("the client fails");
    };
    const std::string folder = "failed " + std::to_string(of);
    EXPECT_EQ(testing::refusal<std::runtime_error>([&] { run(folder, 2, fail); }), "the client fails");
    EXPECT_EQ(known_, 3u);
    go_on(folder);
  }
}

TEST_F(IslandRanks, EndTogetherIfTheRunIsPaused) {
  const auto boxes = std::make_shared<LocalChannel::Boxes>(2);
  LocalChannel channel(boxes, 0), other(boxes, 1);
  {
    const std::jthread thread([&] { evodevo::Run::serve(other, [] { return RunSpec(); }); });
    auto run = evodevo::Run::begin(read(), {.folder = scratch_ / "paused", .ranks = &channel});
    EXPECT_TRUE(run.advance());
    run.pause();
    EXPECT_FALSE(run.advance());
    EXPECT_FALSE(run.is_finished());
    run.finish();
  }
  go_on("paused");
}

TEST_F(IslandRanks, EndTogetherIfTheFolderOfAnIslandIsLost) {
  const auto lose = [&](std::int64_t island, const Summary& summary) {
    if (island == 1 && summary.generation == 1) fs::rename(scratch_ / "lost/island-3", scratch_ / "away");
  };
  EXPECT_THAT(testing::refusal<std::runtime_error>([&] { run("lost", 3, lose); }), naming("rank 2 on ", "island-3"));
  EXPECT_EQ(known_, 0u) << "not all archives can be opened";
  fs::rename(scratch_ / "away", scratch_ / "lost/island-3");
  go_on("lost");
}

TEST_F(IslandRanks, SayWhatARankIsToldWrongly) {
  const auto others = []() -> RunSpec { throw InputError("--threads x: expected a number"); };
  EXPECT_THAT(testing::refusal<std::runtime_error>([&] { run("told", 2, {}, others); }),
              naming("rank 1 on ", "--threads x"));
  go_on("told");
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
