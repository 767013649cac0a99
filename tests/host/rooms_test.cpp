// Rules on which folders may include which other folders: see framework/README.md and kernels/README.md.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "support/scratch.hpp"

namespace evodevo::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;

const fs::path source = EVODEVO_SOURCE_FOLDER;

/// The layers, lowest first: a folder may include itself and folders of lower layers, but no other folder of its layer.
using Floors = std::vector<std::set<std::string>>;
const Floors floors{{"kernels/include"},
                    {"kernels/threads", "kernels/physics"},
                    {"kernels/core"},
                    {"kernels/analysis"},
                    {"kernels/cpu", "kernels/cuda"},
                    {"framework/sdk"},
                    {"framework/base"},
                    {"framework/operators"},
                    {"framework/experiment"},
                    {"framework/life"},
                    {"framework/archive"},
                    {"framework/evolution"},
                    {"framework/cluster"},
                    {"framework/engine"},
                    {"framework/report"},
                    {"framework/commands"},
                    {"tools/parts"},
                    {"framework/main.cpp"}};

/// Returns the name by which `floors` lists the folder of a file: "framework/life" for framework/life/birth.cpp.
std::string room_of(const fs::path& file) {
  const fs::path relative = fs::relative(file, source);
  auto part = relative.begin();
  const fs::path first = *part++;
  return (first / *part).string();
}

std::size_t floor_of(const std::string& room) {
  const auto found =
      std::find_if(floors.begin(), floors.end(), [&](const auto& rooms) { return rooms.contains(room); });
  EXPECT_NE(found, floors.end()) << room << " stands on no floor: add it to the list above";
  return static_cast<std::size_t>(found - floors.begin());
}

std::vector<fs::path> sources_in(const std::string& folder) {
  static const std::set<std::string> endings{".cpp", ".hpp", ".cu", ".cuh"};
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(source / folder))
    if (entry.is_regular_file() && endings.contains(entry.path().extension()) &&
        room_of(entry.path()) != "framework/template")
      files.push_back(entry.path());
  return files;
}

/// Returns the file of this project that an #include "..." names, or nothing if it belongs to another project.
std::optional<fs::path> included(const std::string& name) {
  for (const char* root : {"framework", "kernels", "kernels/include", "framework/sdk", "tools/parts/commands"})
    if (fs::exists(source / root / name)) return source / root / name;
  return std::nullopt;
}

template <class Use>
void for_each_include(const Use& use) {
  static const std::regex include("#include \"([^\"]+)\"");
  for (const char* part : {"kernels", "framework", "tools/parts/commands"})
    for (const fs::path& file : sources_in(part)) {
      const std::string text = testing::content_of(file);
      for (std::sregex_iterator found(text.begin(), text.end(), include), end; found != end; ++found)
        if (const auto other = included((*found)[1])) use(file, *other);
    }
}

TEST(Rooms, IncludeOnlyWhatLiesBelow) {
  int includes = 0;
  for_each_include([&](const fs::path& file, const fs::path& other) {
    ++includes;
    const std::string from = room_of(file), to = room_of(other);
    if (from == to) return;
    EXPECT_LT(floor_of(to), floor_of(from)) << fs::relative(file, source) << " includes " << other;
  });
  EXPECT_GT(includes, 300) << "or the includes are not found";
}

TEST(Rooms, OfTheCoreOpenOnlyTheOnesForCallers) {
  static const std::set<std::string> open{"kernels/include", "kernels/core", "kernels/analysis", "kernels/threads"};
  for_each_include([&](const fs::path& file, const fs::path& other) {
    const std::string opened = fs::relative(other, source).string();
    const bool is_device = opened == "kernels/cpu/simulator.hpp" || opened == "kernels/cuda/runtime/cuda_simulator.hpp";
    const bool enters = room_of(file).starts_with("framework/") && room_of(other).starts_with("kernels/");
    if (!enters || is_device) return;
    EXPECT_THAT(open, ::testing::Contains(room_of(other))) << fs::relative(file, source) << " includes " << other;
  });
}

}  // namespace
}  // namespace evodevo::EVODEVO_FILE
