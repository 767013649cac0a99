// What selection operators remember and note: it is committed with the generation, and given back when a run is
// resumed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "commands/run/run.hpp"
#include "evodevo/helpers/rows.hpp"
#include "evodevo/helpers/selection/memory.hpp"
#include "evolution/evolution.hpp"
#include "evolution/record_check.hpp"
#include "support/experiments.hpp"
#include "support/messages.hpp"
#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

/// Remembers how often it was called, and notes that about the first row. It could also note a sum.
struct Counting final : Selection {
  std::vector<NoteTitle> notes() const override { return {{"calls"}, {"sum", "ids"}}; }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> couples(const SelectionContext& context, std::uint32_t count,
                                                               Rng& rng) const override {
    EXPECT_EQ(calls_in(context), apart ? 0 : context.generation) << "parents are chosen with the memory";
    return draw_pairs(context.rows, count, rng, draw_any);
  }
  Survival survive(const SelectionContext& context, std::uint32_t population, Rng&) const override {
    Survival survival{best_first(context.rows)};
    survival.rows.resize(std::min<std::size_t>(survival.rows.size(), population));
    const std::uint64_t calls = calls_in(context) + 1;
    EXPECT_EQ(calls, context.generation + 1u);
    MemoryWriter writer;
    writer.write(calls);
    survival.memory = writer.bytes();
    survival.notes = {{0, 0, static_cast<double>(calls)}};
    if (fault) fault(survival);
    return survival;
  }
  static std::uint64_t calls_in(const SelectionContext& context) {
    return context.memory.empty() ? 0 : MemoryReader(context.memory).read<std::uint64_t>();
  }

  bool apart = false;
  std::function<void(Survival&)> fault;
};

class Remembering : public ::testing::Test {
 protected:
  Remembering() {
    auto op = std::make_unique<Counting>();
    counting_ = op.get();
    experiment_.selection = std::move(op);
    experiment_.notes = counting_->notes();
  }
  /// Evolves until so many generations have been committed.
  void evolve_to(Archive& archive, std::size_t generations) {
    std::atomic<bool> stop = archive.generations().size() >= generations;
    Observer observer;
    observer.generation_done = [&](const Summary& summary) { stop = summary.generation + 1 >= generations; };
    evolve(experiment_, *make_cpu_simulator(experiment_.scene, experiment_.stepping, 1), archive, stop, observer);
  }
  std::string fault_of(const std::function<void(Survival&)>& fault) {
    counting_->fault = fault;
    Archive archive = Archive::create(scratch_ / ("fault" + std::to_string(faults_++)), experiment_, "test");
    try {
      evolve_to(archive, 1);
    } catch (const std::runtime_error& error) {
      EXPECT_TRUE(archive.generations().empty());
      return error.what();
    }
    return "none";
  }

  testing::Scratch scratch_;
  Experiment experiment_ = testing::read(testing::small_experiment);
  Counting* counting_;
  int faults_ = 0;
};

TEST(Memory, HoldsFiniteNumbersAlone) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  MemoryWriter writer;
  writer.write(std::vector<double>{0.5, 1e300});
  EXPECT_THROW(writer.write(infinity), std::runtime_error);
  EXPECT_THROW(writer.write(std::vector<float>{0, std::nanf("")}), std::runtime_error);
  EXPECT_EQ(MemoryReader(writer.bytes()).read_list<double>(), (std::vector<double>{0.5, 1e300}));
  std::vector<std::byte> bytes = writer.bytes();
  std::memcpy(bytes.data() + sizeof(std::uint64_t), &infinity, sizeof infinity);
  EXPECT_THROW(MemoryReader(bytes).read_list<double>(), std::runtime_error);
}

TEST_F(Remembering, IsCommittedWithTheGenerationAndGivenBack) {
  {
    Archive archive = Archive::create(scratch_ / "run", experiment_, "test");
    EXPECT_TRUE(archive.memory().empty());
    evolve_to(archive, 2);
    EXPECT_EQ(MemoryReader(archive.memory()).read<std::uint64_t>(), 2u);
  }
  Archive archive = Archive::resume(scratch_ / "run");
  check_resumable(archive, experiment_);
  evolve_to(archive, 4);
  EXPECT_EQ(MemoryReader(archive.memory()).read<std::uint64_t>(), 4u);
}

TEST_F(Remembering, NotesOfAnIndividualAreTheLastOnes) {
  Archive archive = Archive::create(scratch_ / "run", experiment_, "test");
  evolve_to(archive, 3);
  std::size_t noted = 0;
  double last = 0;
  for (std::uint32_t id = 0; id < 18; ++id)
    for (const ArchivedNote& note : archive.notes(id)) {
      ++noted;
      EXPECT_EQ(note.name, "calls");
      last = std::max(last, note.value);
    }
  EXPECT_EQ(last, 3);
  EXPECT_LE(noted, 3u);
  EXPECT_EQ(archive.note_titles().at(1).unit, "ids");
}

TEST_F(Remembering, AnotherOperatorForParentsHasNoMemory) {
  auto parents = std::make_unique<Counting>();
  parents->apart = true;
  experiment_.parent_selection = std::move(parents);
  Archive archive = Archive::create(scratch_ / "run", experiment_, "test");
  evolve_to(archive, 3);
  EXPECT_EQ(MemoryReader(archive.memory()).read<std::uint64_t>(), 3u);
}

TEST_F(Remembering, FaultsAreNamedBeforeAnythingIsCommitted) {
  EXPECT_THAT(fault_of([](Survival& s) {
                s.notes.push_back({0, 1, std::nan("")});
              }),
              testing::naming("selection operator", "sum", "finite"));
  EXPECT_THAT(fault_of([](Survival& s) { s.notes.push_back({0, 2, 1}); }), testing::naming("number 2", "2 numbers"));
  EXPECT_THAT(fault_of([](Survival& s) { s.notes.push_back({0, 0, 2}); }), testing::naming("calls", "twice", "row 0"));
  EXPECT_THAT(fault_of([](Survival& s) { s.notes.push_back({99, 0, 1}); }), testing::naming("row 99", "6 rows"));
  EXPECT_THAT(fault_of([](Survival& s) { s.rows.push_back(s.rows[0]); }), testing::naming("survivors", "different"));
  EXPECT_THAT(fault_of([](Survival& s) { s.memory.resize((std::size_t{128} << 20) + 1); }),
              testing::naming("134217729", "134217728"));
}

TEST_F(Remembering, TheRecordOfAnotherOperatorIsRefused) {
  Archive archive = Archive::create(scratch_ / "run", experiment_, "test");
  evolve_to(archive, 1);
  experiment_.notes = {{"calls"}};
  EXPECT_THAT([&] { check_resumable(archive, experiment_); },
              ::testing::ThrowsMessage<ArchiveError>(testing::naming("sum in ids", "calls in 1")));
}

/// Makes children that are all equal, and counts those that it sees again.
struct Twins final : Selection {
  std::vector<Child> children(const SelectionContext& context, std::uint32_t count, Rng&) const override {
    return std::vector<Child>(count, {Genome(context.layout.first_size(), 1)});
  }
  Survival survive(const SelectionContext& context, std::uint32_t, Rng&) const override {
    const auto newborns =
        std::count_if(context.rows.begin(), context.rows.end(), [](const Candidate& row) { return row.is_newborn; });
    return {{0}, {static_cast<std::byte>(newborns)}};
  }
};

TEST_F(Remembering, AnOperatorSeesAllChildrenThatItHasMadeItself) {
  experiment_.selection = std::make_unique<Twins>();
  experiment_.notes.clear();
  experiment_.child_maker = "twins";
  experiment_.random_individuals = 0;
  experiment_.children = 4;
  experiment_.development.cycles = 0;  // equal genes have equal scores, because development draws no random numbers
  const auto seen = [&](const char* folder) {
    Archive archive = Archive::create(scratch_ / folder, experiment_, "test");
    evolve_to(archive, 2);
    EXPECT_EQ(archive.generations().back().evaluations, 8) << "four in each generation, the first included";
    EXPECT_EQ(archive.generations().back().clones, 4);
    return std::to_integer<int>(archive.memory().at(0));
  };
  EXPECT_EQ(seen("own"), 4);
  experiment_.parent_selection = std::make_unique<Twins>();
  EXPECT_EQ(seen("apart"), 1) << "copies are removed if another operator chooses the survivors";
}

TEST(Memory, IsReadAsItWasWritten) {
  MemoryWriter writer;
  writer.write(std::uint32_t{7});
  writer.write(std::vector<float>{1.5F, -2});
  writer.write(-0.0);
  writer.write(std::vector<double>{});
  const std::vector<std::vector<double>> lists{{1, 2}, {}, {3}};
  writer.write(lists);
  MemoryReader reader(writer.bytes());
  EXPECT_EQ(reader.read<std::uint32_t>(), 7u);
  EXPECT_EQ(reader.read_list<float>(), (std::vector<float>{1.5F, -2}));
  EXPECT_TRUE(std::signbit(reader.read<double>()));
  EXPECT_TRUE(reader.read_list<double>().empty());
  EXPECT_EQ(reader.read_lists<double>(), lists);
  reader.finish();
}

TEST(Memory, ThatIsTooShortOrTooLongIsRefused) {
  MemoryWriter writer;
  writer.write(std::vector<double>{1, 2, 3});
  const std::span<const std::byte> all = writer.bytes();
  for (std::size_t left = 0; left < all.size(); ++left) {
    MemoryReader reader(all.first(left));
    EXPECT_THROW(reader.read_list<double>(), std::runtime_error) << left;
  }
  MemoryReader reader(all);
  reader.read<std::uint64_t>();
  EXPECT_THAT([&] { reader.finish(); }, ::testing::ThrowsMessage<std::runtime_error>(::testing::HasSubstr("24")));
  MemoryWriter huge;
  huge.write(std::numeric_limits<std::uint64_t>::max());
  EXPECT_THROW(MemoryReader(huge.bytes()).read_list<double>(), std::runtime_error) << "no memory is allocated for it";
  EXPECT_THROW(MemoryReader(huge.bytes()).read_lists<double>(), std::runtime_error) << "nor for lists";
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
