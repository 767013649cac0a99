// The folder of a run with islands. It holds a folder for each island, which is an ordinary folder of a run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "archive/archive.hpp"

namespace evodevo {

/// Returns the folder of an island, numbered from 1, in the folder of its run.
std::filesystem::path island_folder(const std::filesystem::path& run, std::int64_t island);

/// Returns the folders of the islands of the run in a folder, in the order of their numbers. Returns nothing if there
/// is no run with islands. Throws ArchiveError if folders of islands are missing.
std::vector<std::filesystem::path> island_folders(const std::filesystem::path& run);

/// Whether a process ended while it created the archives of a run with `count` islands: some are not begun, and those
/// that are hold no generation.
bool is_half_created(const std::filesystem::path& run, std::int64_t count);

/// Returns the folders in which there are archives: those of the islands of the run in a folder, or else the folder.
std::vector<std::filesystem::path> archive_folders(const std::filesystem::path& run);

/// An individual of an island that has a fitness.
struct IslandIndividual {
  double score = 0;        ///< first objective, negated if less is better
  std::size_t island = 0;  ///< index of its archive
  std::uint32_t id = 0;
};

/// Returns the `count` individuals with the best first objective in the archives of a run's islands, the best first.
std::vector<IslandIndividual> best_of_islands(const std::vector<Archive>& archives, std::size_t count);

/// Returns the next generation of each archive, which is the number of its complete ones.
std::vector<std::uint32_t> next_generations(const std::vector<Archive>& archives);

}  // namespace evodevo
