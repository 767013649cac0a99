// Properties of random bodies in random scenes hold on the GPU as well, and the GPU agrees with the CPU.
#include <algorithm>
#include <string>

#include "gpu.hpp"
#include "physics/random_lives.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

using test::Answer;
using test::Life;
using test::mirrored;

class Property : public ::testing::TestWithParam<test::Arithmetic> {
 protected:
  static Stepping stepping() { return {std::get<Method>(GetParam()), std::get<Precision>(GetParam())}; }
  static std::unique_ptr<Simulator> simulator(const Scene& scene) { return make_cuda_simulator(scene, stepping()); }

  /// How far different rounding may move positions apart, m; about ten times the deviations observed.
  static double rounding() { return stepping().precision == Precision::float32 ? 1e-2 : 1e-9; }

  /// Calls `check(scene, lives)` for each of 16 random scenes.
  template <class F>
  static void for_random_scenes(const F& check) {
    for (std::uint64_t seed = 0; seed < 16; ++seed) {
      SCOPED_TRACE("random_scene(" + std::to_string(seed) + ")");
      const Scene scene = test::random_scene(seed);
      check(scene, test::random_lives(scene, seed, 64));
    }
  }
};

std::string trace(const Life& life) { return "the life of seed " + std::to_string(life.seed); }

INSTANTIATE_TEST_SUITE_P(Gpu, Property, all_ways(), [](const auto& instance) { return test::name_of(instance.param); });

TEST_P(Property, EveryLifeIsThatOfTheCpu) {
  EVODEVO_NEEDS_GPU();
  for_random_scenes([&](const Scene& scene, const std::vector<Life>& lives) {
    const std::vector<Answer> cpu = test::simulate(*make_cpu_simulator(scene, stepping(), 0), lives);
    const std::vector<Answer> gpu = test::simulate(*simulator(scene), lives);
    for (std::size_t i = 0; i < lives.size(); ++i) {
      EXPECT_EQ(gpu[i].task.status, Status::ok) << trace(lives[i]) << ": " << gpu[i].task.reason;
      EXPECT_LT(distance(cpu[i].state, gpu[i].state), rounding()) << trace(lives[i]);
    }
  });
}

TEST_P(Property, TheSameBitsInAnyOrder) {
  EVODEVO_NEEDS_GPU();
  for_random_scenes([&](const Scene& scene, std::vector<Life> lives) {
    const Recording all{.stress = true, .work = true};
    const std::vector<Answer> once = test::simulate(*simulator(scene), lives, all);
    std::reverse(lives.begin(), lives.end());
    std::vector<Answer> again = test::simulate(*simulator(scene), lives, all);
    std::reverse(again.begin(), again.end());
    for (std::size_t i = 0; i < once.size(); ++i) {
      EXPECT_TRUE(test::same_bits(once[i].state, again[i].state)) << trace(lives[lives.size() - 1 - i]);
      EXPECT_EQ(once[i].task.stress, again[i].task.stress);
      EXPECT_EQ(once[i].task.work, again[i].task.work);
    }
  });
}

TEST_P(Property, AMirroredBodyMovesAsTheMirrorImage) {
  EVODEVO_NEEDS_GPU();
  for_random_scenes([&](const Scene& scene, const std::vector<Life>& lives) {
    std::vector<Life> images = lives;
    for (Life& life : images) life.start = mirrored(life.start);
    const std::vector<Answer> real = test::simulate(*simulator(scene), lives);
    const std::vector<Answer> image = test::simulate(*simulator(mirrored(scene)), images);
    for (std::size_t i = 0; i < lives.size(); ++i)
      EXPECT_LT(distance(mirrored(image[i].state), real[i].state), rounding()) << trace(lives[i]);
  });
}

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
