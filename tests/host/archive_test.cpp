// The archive: data that is written can be read again, and no process overwrites the data of another.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>

#include "evolution/archive/archive_writer.hpp"
#include "evolution/archive/schema.hpp"
#include "support/archives.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class ArchiveTest : public ::testing::Test {
 protected:
  std::string refusal(const std::function<void()>& call) {
    try {
      call();
    } catch (const ArchiveError& error) {
      return error.what();
    }
    return "no refusal";
  }

  testing::Scratch scratch_;
  fs::path folder_ = scratch_ / "run";
  Experiment experiment_ = testing::read(testing::small_experiment);
};

TEST_F(ArchiveTest, GivesBackWhatWasCommitted) {
  Individual ok;
  ok.id = 4;
  ok.born = 2;
  ok.origin = 1;
  ok.parents = {1, 3};
  ok.made_by = "two-point";
  ok.genome = {0.25f, 3};
  ok.result.objectives = {0.1 + 0.2, -1e-300};
  ok.result.spring_evaluations = 12345678901;
  Individual diverged = ok;
  diverged.id = 5;
  diverged.parents = {};
  diverged.result = {Status::diverged, "non-finite", 1.5, {}, 7};
  const Summary summary{.generation = 2,
                        .evaluations = 6,
                        .best = 0.3,
                        .median = std::nullopt,
                        .diverged = 1,
                        .invalid = 0,
                        .clones = 2,
                        .spring_evaluations = 9,
                        .wall_time = 0.5};
  {
    Archive archive = Archive::create(folder_, experiment_, "a device");
    for (std::uint32_t generation = 0; generation < 2; ++generation)
      archive.commit({}, {}, {}, {.generation = generation, .evaluations = 2 + generation});
    archive.commit({ok, diverged}, {5}, {}, summary);
  }
  const Archive archive = Archive::read(folder_);
  EXPECT_EQ(archive.record("seed"), "7");
  EXPECT_EQ(archive.provenances().front().device, "a device");
  EXPECT_EQ(recorded_experiment(archive).resolved, experiment_.resolved);
  ASSERT_EQ(archive.population().size(), 1u);
  const Individual back = archive.population().front();
  EXPECT_EQ(back.id, 4u);
  EXPECT_EQ(back.born, 2u);
  EXPECT_EQ(back.origin, 1u);
  EXPECT_EQ(back.parents, ok.parents);
  EXPECT_EQ(back.made_by, ok.made_by);
  EXPECT_EQ(back.genome, ok.genome);
  EXPECT_EQ(back.result.objectives, ok.result.objectives) << "to the last bit";
  EXPECT_EQ(back.result.spring_evaluations, ok.result.spring_evaluations);
  const ArchivedIndividual dead = archive.individual(5).value();
  EXPECT_EQ(dead.died, 2u);
  EXPECT_EQ(dead.result.status, Status::diverged);
  EXPECT_EQ(dead.result.reason, "non-finite");
  EXPECT_EQ(dead.result.ended_at, 1.5);
  EXPECT_TRUE(dead.result.objectives.empty());
  EXPECT_FALSE(archive.individual(6).has_value());
  ASSERT_EQ(archive.generations().size(), 3u);
  EXPECT_EQ(archive.generations()[2].best, 0.3);
  EXPECT_FALSE(archive.generations()[2].median.has_value());
  EXPECT_EQ(archive.generations()[2].clones, 2);
  EXPECT_EQ(archive.best(9), std::vector<std::uint32_t>{4}) << "the diverged one has no place among the best";
  EXPECT_EQ(archive.statuses().at("diverged"), 1);
}

TEST_F(ArchiveTest, TheRefusedLoseTheirScoresWhenTheirGenerationIsCommitted) {
  Individual elder;
  elder.made_by = "random";
  elder.genome = {0.25f, 3};
  elder.result.objectives = {0.4, 1};
  Individual newborn = elder;
  newborn.id = 1;
  newborn.born = 1;
  newborn.origin = 1;
  newborn.result.objectives = {0.3, 2};
  const Verification of_elder{0, 0.4, {{"again", Status::ok, "", 0.4}}};
  {
    Archive archive = Archive::create(folder_, experiment_, "a device");
    archive.commit({elder}, {}, {}, {.generation = 0, .evaluations = 1});
    Archive::annotate(folder_).add_verifications({of_elder});
    EXPECT_TRUE(archive.verification(0).has_value());
    const std::vector<Refusal> refusals{{1, Status::artefact, "quarter-step ends as diverged"},
                                        {0, Status::passive, "no-muscles gives 0.39"}};
    archive.commit({newborn}, {}, {}, {.generation = 1, .evaluations = 2, .artefact = 1, .passive = 1}, {}, refusals);
    Archive::annotate(folder_).add_verifications({of_elder});  // of a process that chose it before
  }
  const Archive archive = Archive::read(folder_);
  EXPECT_EQ(archive.individual(0)->result.status, Status::passive);
  EXPECT_EQ(archive.individual(0)->result.reason, "no-muscles gives 0.39");
  EXPECT_EQ(archive.individual(1)->result.status, Status::artefact);
  EXPECT_EQ(archive.individual(1)->result.reason, "quarter-step ends as diverged");
  EXPECT_TRUE(archive.best(9).empty());
  EXPECT_FALSE(archive.verification(0).has_value());
  EXPECT_EQ(archive.population().size(), 2u) << "selection alone drops";
  EXPECT_EQ(archive.generations()[1].artefact, 1);
  EXPECT_EQ(archive.generations()[1].passive, 1);
  EXPECT_EQ(archive.statuses().at("artefact"), 1);
  EXPECT_EQ(archive.statuses().at("passive"), 1);
}

/// A generation of so many individuals that writing it takes a while.
FinishedGeneration large_generation(std::uint32_t generation) {
  constexpr std::uint32_t size = 20'000;
  FinishedGeneration large;
  for (std::uint32_t i = 0; i < size; ++i) {
    Individual& one = large.newborns.emplace_back();
    one.id = generation * size + i;
    one.born = one.origin = generation;
    one.genome = {static_cast<float>(i), 1};
    one.result.objectives = {static_cast<double>(one.id), 1};
  }
  large.summary = {.generation = generation, .evaluations = (generation + 1) * size, .wall_time = 0.01};
  return large;
}

TEST_F(ArchiveTest, AWriterHasWrittenAllAfterItsWait) {
  Archive archive = Archive::create(folder_, experiment_, "a device");
  {
    ArchiveWriter writer(archive);
    writer.begin(large_generation(0));
    EXPECT_EQ(Archive::read(folder_).generations().size(), 1u) << "it cannot know yet how long writing takes";
    for (const std::uint32_t generation : {1, 2}) writer.begin(large_generation(generation));
    writer.wait();
    EXPECT_GT(writer.seconds(), 0);
    EXPECT_EQ(archive.generations().size(), 3u);
    EXPECT_EQ(archive.individual(59'999)->result.objectives.front(), 59'999);
    writer.begin(large_generation(3));
  }
  EXPECT_EQ(Archive::read(folder_).generations().size(), 4u) << "the destructor waits";
}

TEST_F(ArchiveTest, AWriterThrowsWhatGoesWrong) {
  Archive archive = Archive::create(folder_, experiment_, "a device");
  ArchiveWriter writer(archive);
  writer.begin(large_generation(0));
  const auto again = [&] {
    writer.begin(large_generation(0));
    writer.wait();
  };
  EXPECT_THROW(again(), ArchiveError);
  EXPECT_EQ(archive.generations().size(), 1u);
}

TEST_F(ArchiveTest, TellsWhatEvaluatedAnIndividual) {
  const auto commit = [](Archive& archive, const Provenance& provenance, std::uint32_t id) {
    testing::commit_one(archive, id, archive.add_provenance(provenance));
  };
  const Provenance first = this_provenance(experiment_, "a device");
  Provenance elsewhere = first, rebuilt = first, other_operator = first, moved = first;
  elsewhere.device = "another";
  rebuilt.program = "another";
  other_operator.operators.back().hash = "another";
  moved.operators.front().file = "another";
  {
    Archive archive = Archive::create(folder_, experiment_, "a device");
    commit(archive, first, 0);
    commit(archive, elsewhere, 1);
  }
  {
    Archive archive = Archive::resume(folder_);
    commit(archive, rebuilt, 2);
    commit(archive, other_operator, 3);
    commit(archive, moved, 4);
    commit(archive, elsewhere, 5);
  }
  const Archive archive = Archive::read(folder_);
  ASSERT_EQ(archive.provenances().size(), 4u) << "who comes again, and operators from another place, are nobody new";
  const std::vector<Provenance> expected{first, elsewhere, rebuilt, other_operator, first, elsewhere};
  for (std::uint32_t id = 0; id < 6; ++id) {
    const Provenance provenance = archive.provenances().at(archive.individual(id).value().provenance);
    EXPECT_TRUE(are_same(provenance, expected[id])) << id;
    ASSERT_EQ(provenance.operators.size(), experiment_.uses.size()) << id;
    EXPECT_EQ(provenance.operators.back().version, experiment_.uses.back().version);
  }
  EXPECT_THAT(archive.evaluated_by_provenance(), ::testing::ElementsAre(2, 2, 1, 1));
}

TEST_F(ArchiveTest, TakesVerificationsWhileAnotherWrites) {
  Archive writer = Archive::create(folder_, experiment_, "cpu");
  Individual individual;
  individual.genome = {0.5f};
  individual.result.objectives = {0.3, 1};
  writer.commit({individual}, {}, {}, {.generation = 0, .evaluations = 1});
  EXPECT_FALSE(Archive::read(folder_).verification(0).has_value());
  Archive::annotate(folder_).add_verifications({{0, 0.3, {{"again", Status::ok, "", 7}}}});
  const std::vector<Trial> trials{{"settled", Status::diverged, "too wild", std::nullopt},
                                  {"again", Status::ok, "", 0.1 + 0.2}};
  Archive::annotate(folder_).add_verifications({{0, 0.3, trials}});
  const Verification back = Archive::read(folder_).verification(0).value();
  EXPECT_EQ(back.individual, 0u);
  EXPECT_EQ(back.fitness, 0.3);
  ASSERT_EQ(back.trials.size(), 2u) << "the later one took the place of the first";
  EXPECT_EQ(back.trials[0].name, "settled");
  EXPECT_EQ(back.trials[0].status, Status::diverged);
  EXPECT_EQ(back.trials[0].reason, "too wild");
  EXPECT_FALSE(back.trials[0].value.has_value());
  EXPECT_EQ(back.trials[1].value, 0.1 + 0.2);
}

TEST_F(ArchiveTest, NeverWritesOverARun) {
  { Archive::create(folder_, experiment_, "cpu"); }
  EXPECT_THAT(
      refusal([&] { Archive::create(folder_, experiment_, "cpu"); }),
      testing::at_place(folder_.string() + ": ", "not empty", "--out", "`evodevo resume " + folder_.string() + "`"));
}

TEST_F(ArchiveTest, NeverTouchesAFolderOfOtherThings) {
  fs::create_directories(folder_);
  std::ofstream(folder_ / "thesis.txt") << "years of work";
  EXPECT_NE(refusal([&] { Archive::create(folder_, experiment_, "cpu"); }), "no refusal");
  EXPECT_EQ(fs::file_size(folder_ / "thesis.txt"), 13u);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1) << "nothing was added";
}

TEST_F(ArchiveTest, SaysWhereThereIsNoRun) {
  EXPECT_THAT(refusal([&] { Archive::read(folder_); }),
              testing::at_place(folder_.string() + ": ", "no run.sqlite", "`evodevo run`"));
  EXPECT_EQ(refusal([&] { Archive::resume(folder_); }), refusal([&] { Archive::read(folder_); }));
  EXPECT_FALSE(fs::exists(folder_)) << "looking leaves nothing behind";
}

TEST_F(ArchiveTest, ARunThatEndedBeforeItBeganIsTold) {
  fs::create_directories(folder_);
  std::ofstream(folder_ / "run.sqlite").close();  // the file that is left if the first transaction was not committed
  const std::string said = refusal([&] { Archive::resume(folder_); });
  EXPECT_THAT(said, AllOf(StartsWith(folder_.string()), HasSubstr("run.sqlite-wal"), HasSubstr("another folder")));
  EXPECT_THAT(said, Not(HasSubstr("remove"))) << "it advises nothing that destroys";
}

TEST_F(ArchiveTest, AnotherFormatIsRefused) {
  { Archive::create(folder_, experiment_, "cpu").set_record("format", "99"); }
  EXPECT_THAT(
      refusal([&] { Archive::read(folder_); }),
      testing::at_place(folder_.string() + ": ", "format 99", std::string("format ") + archive_format, "0.1.0"));
}

TEST_F(ArchiveTest, ReadsOfOneMomentWhileAnotherWrites) {
  Archive writer = Archive::create(folder_, experiment_, "cpu");
  const Archive reader = Archive::read(folder_);
  EXPECT_EQ(reader.generations().size(), 0u);
  writer.commit({}, {}, {}, {.generation = 0, .evaluations = 0});
  EXPECT_EQ(reader.generations().size(), 0u);
  EXPECT_EQ(Archive::read(folder_).generations().size(), 1u);
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
