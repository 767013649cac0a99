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
#include "machine_code.hpp"
#include "paper/paper_simulator.hpp"
#include "paper/sources.hpp"
#include "paper/stress_methods.hpp"

namespace evodevo::cuda::EVODEVO_FILE {

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

/// A feature, and the one that it is part of, or nullptr.
struct Feature {
  const char* name;
  bool Features::*on;
  bool Features::*whole;
};

constexpr std::nullptr_t always = nullptr;
#define EVODEVO_FEATURE(name, whole) {#name, &Features::name, whole_##whole},
#define EVODEVO_WHOLE(name, whole) constexpr bool Features::*whole_##name = &Features::name;
constexpr bool Features::*whole_always = always;
EVODEVO_FEATURES(EVODEVO_WHOLE)
const std::vector<Feature> all_features{EVODEVO_FEATURES(EVODEVO_FEATURE)};

Features with_every_feature() {
  Features features;
  for (const Feature& feature : all_features) features.*feature.on = true;
  return features;
}
const Features every_feature = with_every_feature();

Features without(const Feature& feature) {
  Features features = every_feature;
  features.*feature.on = false;
  for (const Feature& part : all_features)  // a whole stands before its parts
    if (part.whole != nullptr && !(features.*part.whole)) features.*part.on = false;
  return features;
}

/// A form of a kernel: of a body on the chip if it has rows, otherwise of one that is streamed.
struct Form {
  const char* name;
  ResidentForm resident;
};

const std::vector<Form> forms{
    {"on the chip", {.rows = most_rows, .masses_per_thread = 1, .records_on_chip = true}},
    {"springs streamed",
     {.rows = rows_of_a_chunk, .masses_per_thread = 5, .chunked = true, .wide_offsets = true, .wide_table = true}},
    {"in a cluster", {.rows = most_rows, .masses_per_thread = 2, .records_on_chip = true, .clustered = true}},
    {"in a cluster, springs streamed",
     {.rows = rows_of_a_chunk, .masses_per_thread = 5, .chunked = true, .wide_offsets = true, .clustered = true}},
    {"streamed", {}}};

std::vector<char> compiled(const Form& form, const Features& features, const char* architecture = "sm_90") {
  if (form.resident.rows > 0)
    return compile("cuda/device/resident.cu", definitions(features, form.resident), architecture);
  return compile(is_explicit(features.method) ? "cuda/device/streamed/streamed.cu" : form_of(features.method).file,
                 definitions(features), architecture);
}

TEST_F(Compiler, CompilesForGpusWithoutClustersAndForLaterOnes) {
  EXPECT_FALSE(compiled(forms[0], every_feature, "sm_80").empty());
  EXPECT_FALSE(compiled(forms[2], every_feature, "sm_120").empty());
}

/// In CUDA's PTX, as for a GPU that the compiler does not know: functions of a feature refuse to be compiled without
/// it.
TEST_F(Compiler, CallsNoFunctionOfAFeatureThatIsOff) {
  for (const Feature& feature : all_features)
    for (const std::size_t form : {std::size_t{0}, forms.size() - 1})
      EXPECT_NO_THROW(compiled(forms[form], without(feature), "sm_999")) << feature.name << ", " << forms[form].name;
}

/// Kernels that keep a body on the chip have 64 registers per thread, and with many features that is too little.
TEST_F(Compiler, CompilesEveryFormAndKeepsAllInRegistersWhereTheySuffice) {
  const auto expect_registers_to_suffice = [](const Form& form, const Features& features, const char* kernel) {
    const auto code = tools::bench::machine_code(compiled(form, features)).at(kernel);
    EXPECT_GT(code.instructions, 0u) << form.name;
    EXPECT_EQ(code.local_accesses, 0u) << form.name << (features.float64 ? ", float64" : ", float32");
  };
  for (const bool float64 : {false, true}) {
    Features none{.float64 = float64}, all = every_feature;
    all.float64 = float64;
    for (const Features& features : {none, all})
      expect_registers_to_suffice(forms.back(), features, "evodevo_pass_streamed");
    for (const std::size_t resident : {0, 2})
      expect_registers_to_suffice(forms[resident], none, "evodevo_run_resident");
    for (const Form& form : forms)
      for (const Features& features : {none, all}) EXPECT_FALSE(compiled(form, features).empty()) << form.name;
  }
}

TEST_F(Compiler, CompilesEveryMethodForHopper) {
  for (std::size_t i = 1; i < method_names.size(); ++i) {
    Features features = every_feature;
    features.method = static_cast<Method>(i);
    EXPECT_FALSE(compiled(forms.back(), features).empty()) << method_names[i];
    if (is_explicit(features.method)) {
      EXPECT_FALSE(compiled(forms.front(), features).empty()) << method_names[i];
    }
    features = {.method = features.method, .float64 = true};
    EXPECT_FALSE(compiled(forms.back(), features).empty()) << method_names[i];
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

}  // namespace evodevo::cuda::EVODEVO_FILE
