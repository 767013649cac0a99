#include "archive/island_folders.hpp"

#include <algorithm>
#include <functional>

#include "archive/recorded_experiment.hpp"
#include "base/text.hpp"

namespace evodevo {

namespace fs = std::filesystem;

fs::path island_folder(const fs::path& run, std::int64_t island) {
  return run / (island_folder_prefix + std::to_string(island));
}

std::vector<fs::path> island_folders(const fs::path& run) {
  std::vector<fs::path> folders;
  if (!has_islands(run)) return folders;
  const Settings settings = recorded_settings(Archive::read(island_folder(run, 1)));
  const std::int64_t count = settings.islands ? settings.islands->count : 1;
  for (std::int64_t island = 1; island <= count; ++island) {
    folders.push_back(island_folder(run, island));
    if (std::error_code error; !fs::is_directory(folders.back(), error))
      throw ArchiveError(folders.back().string() + ": is missing, but the run has " + std::to_string(count) +
                         " islands; put the folder back, or begin the run again, in another folder or, if it has no "
                         "generation yet, in this one");
  }
  return folders;
}

bool is_half_created(const fs::path& run, std::int64_t count) {
  bool lacks_one = false;
  for (std::int64_t island = 1; island <= count; ++island) {
    const fs::path folder = island_folder(run, island);
    if (!is_begun(folder))
      lacks_one = true;
    else if (!Archive::read(folder).generations().empty())
      return false;
  }
  return has_islands(run) && lacks_one;
}

std::vector<fs::path> archive_folders(const fs::path& run) {
  std::vector<fs::path> folders = island_folders(run);
  if (folders.empty()) folders.push_back(run);
  return folders;
}

std::vector<IslandIndividual> best_of_islands(const std::vector<Archive>& archives, std::size_t count) {
  std::vector<IslandIndividual> best;
  for (std::size_t i = 0; i < archives.size(); ++i) {
    const double sign = archives[i].objectives().front().maximise ? 1 : -1;
    for (const std::uint32_t id : archives[i].best(count))
      best.push_back({sign * archives[i].known_individual(id).result.objectives.front(), i, id});
  }
  std::ranges::stable_sort(best, std::greater(), &IslandIndividual::score);
  best.resize(std::min(best.size(), count));
  return best;
}

std::vector<std::uint32_t> next_generations(const std::vector<Archive>& archives) {
  std::vector<std::uint32_t> next;
  for (const Archive& archive : archives) next.push_back(static_cast<std::uint32_t>(archive.generations().size()));
  return next;
}

}  // namespace evodevo
