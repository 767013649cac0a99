// Kernels can be compiled without a GPU, and are compiled only once.
#include "cuda/runtime/compiler.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "cuda/layout/features.hpp"
#include "cuda/runtime/cache.hpp"
#include "paper/paper_simulator.hpp"
#include "paper/sources.hpp"
#include "paper/stress_methods.hpp"

namespace evodevo::cuda::EVODEVO_FILE {
namespace {

namespace fs = std::filesystem;

/// Uses a separate cache for the test.
class Compiler : public ::testing::Test {
 protected:
  Compiler() : cache_(fs::temp_directory_path() / ("evodevo-cache-" + std::to_string(::getpid()))) {
    ::setenv("XDG_CACHE_HOME", cache_.c_str(), 1);
  }
  ~Compiler() override { fs::remove_all(cache_); }

  std::vector<fs::path> files() const {
    std::vector<fs::path> found;
    for (const auto& entry : fs::recursive_directory_iterator(cache_))
      if (entry.is_regular_file()) found.push_back(entry.path());
    return found;
  }

  fs::path cache_;
};

const Features every_feature{.gravity = true,
                             .slope = true,
                             .floor = true,
                             .elastic = true,
                             .rigid = true,
                             .rough = true,
                             .friction = true,
                             .static_friction = true,
                             .damping = true,
                             .drag = true,
                             .actuation = true,
                             .dashpots = true,
                             .stress = true,
                             .work = true,
                             .peak_force = true,
                             .muscle_work = true,
                             .tension = true};

/// Whether the kernels that simulate bodies of any size compile with the given features and method.
bool compiles_streamed(const Features& features) {
  const char* source =
      is_explicit(features.method) ? "cuda/device/streamed/streamed.cu" : form_of(features.method).file;
  return !compile(source, definitions(features), "sm_90").empty();
}

TEST_F(Compiler, CompilesForGpusWithoutClustersAndForLaterOnes) {
  const ResidentForm alone{.rows = most_rows, .masses_per_thread = 1, .records_on_chip = true};
  ResidentForm clustered = alone;
  clustered.clustered = true;
  EXPECT_FALSE(compile("cuda/device/resident.cu", definitions(every_feature, alone), "sm_80").empty());
  EXPECT_FALSE(compile("cuda/device/resident.cu", definitions(every_feature, clustered), "sm_120").empty());
}

TEST_F(Compiler, CompilesEveryFormForHopper) {
  const ResidentForm forms[] = {
      {.rows = most_rows, .masses_per_thread = 1, .chunked = false, .records_on_chip = true},
      {.rows = rows_of_a_chunk, .masses_per_thread = 5, .chunked = true, .wide_offsets = true, .wide_table = true},
      {.rows = most_rows, .masses_per_thread = 2, .records_on_chip = true, .clustered = true},
      {.rows = rows_of_a_chunk, .masses_per_thread = 5, .chunked = true, .wide_offsets = true, .clustered = true}};
  for (const bool float64 : {false, true}) {
    for (Features features : {Features{}, every_feature}) {
      features.float64 = float64;
      for (const ResidentForm& form : forms)
        EXPECT_FALSE(compile("cuda/device/resident.cu", definitions(features, form), "sm_90").empty());
      EXPECT_TRUE(compiles_streamed(features));
    }
  }
}

TEST_F(Compiler, CompilesEveryMethodForHopper) {
  const ResidentForm form{.rows = most_rows, .masses_per_thread = 1, .records_on_chip = true};
  for (std::size_t i = 1; i < method_names.size(); ++i) {
    Features features = every_feature;
    features.method = static_cast<Method>(i);
    EXPECT_TRUE(compiles_streamed(features)) << method_names[i];
    if (is_explicit(features.method)) {
      EXPECT_FALSE(compile("cuda/device/resident.cu", definitions(features, form), "sm_90").empty()) << method_names[i];
    }
    features = {.method = features.method, .float64 = true};
    EXPECT_TRUE(compiles_streamed(features)) << method_names[i];
  }
}

TEST_F(Compiler, CompilesTheSearchForNeighbours) {
  EXPECT_FALSE(compile("cuda/device/neighbours.cu", {}, "sm_90").empty());
}

TEST_F(Compiler, CompilesThePapersMethods) {
  const Scene scene{Gravity{}, Floor{}, Friction{}, Damping{}, Drag{}};
  const tools::bench::PaperMethod plain{.threads = 1024};
  const auto compiles = [&](const char* source, const tools::bench::PaperMethod& method) {
    return !compile(source, tools::bench::definitions(method, scene), "sm_90", tools::bench::paper_sources()).empty();
  };
  EXPECT_TRUE(compiles("paper/global_memory.cu", plain));
  EXPECT_TRUE(compiles("paper/shared_memory.cu", plain));
  for (const auto& [name, method] : tools::bench::stress_methods(plain))
    EXPECT_TRUE(compiles("paper/shared_memory.cu", method)) << name;
}

TEST_F(Compiler, ReadsTheCache) {
  const auto compiled = compile("cuda/device/streamed/streamed.cu", definitions(every_feature), "sm_90");
  ASSERT_EQ(files().size(), 1u);
  const auto written = fs::last_write_time(files().front());
  EXPECT_EQ(compile("cuda/device/streamed/streamed.cu", definitions(every_feature), "sm_90"), compiled);
  EXPECT_EQ(fs::last_write_time(files().front()), written);
  compile("cuda/device/streamed/streamed.cu", definitions(Features{}), "sm_90");
  EXPECT_EQ(files().size(), 2u);
}

TEST_F(Compiler, DoesNotTrustADamagedCache) {
  store("key", {'a', 'b', 'c'});
  EXPECT_EQ(load("key"), (std::vector<char>{'a', 'b', 'c'}));
  std::ofstream(files().front(), std::ios::app) << 'd';
  EXPECT_EQ(load("key"), std::nullopt);
}

TEST_F(Compiler, KeepsNothingWhereNoVariableNamesAFolder) {
  const fs::path before = fs::current_path();
  fs::create_directories(cache_ / "here");
  fs::current_path(cache_ / "here");
  // a relative path would refer to a different folder for each working directory
  for (const char* relative : {"", ".", "cache"}) {
    ::setenv("XDG_CACHE_HOME", relative, 1);
    const auto expect_nothing_kept = [&] {
      store("key", {'a'});
      EXPECT_EQ(load("key"), std::nullopt) << relative;
      EXPECT_TRUE(files().empty()) << files().front();
    };
    const std::string home = std::getenv("HOME") != nullptr ? std::getenv("HOME") : "/";
    ::setenv("HOME", relative, 1);
    expect_nothing_kept();
    ::unsetenv("HOME");
    expect_nothing_kept();
    ::setenv("HOME", home.c_str(), 1);
  }
  fs::current_path(before);
}

TEST_F(Compiler, WorksWithoutACache) {
  ::setenv("XDG_CACHE_HOME", "/proc/none", 1);
  EXPECT_FALSE(compile("cuda/device/streamed/streamed.cu", definitions(Features{}), "sm_90").empty());
}

TEST_F(Compiler, NamesAnArchitectureThatIsTooOld) {
  try {
    compile("cuda/device/streamed/streamed.cu", definitions(Features{}), "sm_30");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("sm_30"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace evodevo::cuda::EVODEVO_FILE
