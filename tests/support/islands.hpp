// Runs with islands, for tests.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "archive/island_folders.hpp"
#include "engine/run.hpp"
#include "support/changed.hpp"
#include "support/experiments.hpp"
#include "support/runs.hpp"
#include "support/scratch.hpp"

namespace evodevo::testing {

/// The small experiment as three islands of five individuals, one of which has its own selection, and one its own
/// mutation and seed. Each makes seven generations; individuals migrate after those with odd numbers.
inline const std::string small_islands =
    small_with({{"evaluations = 24\npopulation = 6\n", "evaluations = 104\npopulation = 5\n"}}) + R"(
[islands]
count = 3
every = 2
replaced = "worst"

[[island]]
number = 2
selection.name = "elitist"

[[island]]
number = 3
seed = 41
[[island.mutation]]
name = "reset-weight"
probability = 0.35
)";

inline std::vector<Experiment> read_islands(const Scratch& scratch, const std::string& text,
                                            std::vector<Override> overrides = {}) {
  return evodevo::read_islands({scratch.write("islands.toml", text), std::move(overrides)});
}

/// A point at which a run is interrupted: when an island has completed a generation.
struct Interruption {
  std::int64_t island;
  std::uint32_t generation;
};

/// Begins or continues the run with these islands in a folder.
inline void evolve_islands(std::vector<Experiment> experiments, const std::filesystem::path& folder,
                           std::unique_ptr<Simulator> simulator,
                           std::optional<Interruption> interruption = std::nullopt) {
  std::vector<Archive> archives;
  for (const Experiment& island : experiments) {
    const std::filesystem::path place = island_folder(folder, island.island);
    archives.push_back(std::filesystem::exists(place) ? Archive::resume(place)
                                                      : Archive::create(place, island, simulator->device()));
  }
  std::atomic<bool> stop = false;
  evodevo::Run run(std::move(experiments), std::move(simulator), std::move(archives), &stop);
  run.observe({.generation_done = [&](std::int64_t island, const Summary& summary) {
    if (interruption && interruption->island == island && interruption->generation == summary.generation) stop = true;
  }});
  while (run.advance()) {
  }
  run.pause();
}
inline void evolve_islands(std::vector<Experiment> experiments, const std::filesystem::path& folder, int threads,
                           std::optional<Interruption> interruption = std::nullopt) {
  auto simulator = make_cpu_simulator(experiments.front().scene, experiments.front().stepping, threads);
  evolve_islands(std::move(experiments), folder, std::move(simulator), interruption);
}

/// Expects that the islands of both runs are the same, with their migrants.
inline void expect_same_islands(const std::filesystem::path& a, const std::filesystem::path& b) {
  const auto folders_a = archive_folders(a), folders_b = archive_folders(b);
  ASSERT_EQ(folders_a.size(), folders_b.size());
  for (std::size_t i = 0; i < folders_a.size(); ++i) {
    SCOPED_TRACE(folders_b[i]);
    const Archive one = Archive::read(folders_a[i]), other = Archive::read(folders_b[i]);
    expect_same_runs(one, other);
    for (std::uint32_t id = 0; one.individual(id) && other.individual(id); ++id)
      EXPECT_EQ(one.individual(id)->migrated, other.individual(id)->migrated) << id;
    for (std::size_t to = 1; to <= folders_a.size(); ++to)
      EXPECT_EQ(one.emigrants_to(static_cast<std::int64_t>(to), 0),
                other.emigrants_to(static_cast<std::int64_t>(to), 0));
  }
}

}  // namespace evodevo::testing
