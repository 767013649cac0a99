// If the device's memory is scarce, batches are divided, down to single bodies, and results stay bit-identical.
#include "cuda/runtime/memory.hpp"

#include <cuda_runtime_api.h>
#include <gmock/gmock.h>

#include <stdexcept>

#include "analysis/neighbours.hpp"
#include "cuda/runtime/cuda_neighbours.hpp"
#include "cuda/runtime/device.hpp"
#include "gpu.hpp"
#include "threads/parallel.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

constexpr std::size_t mebibyte = std::size_t{1} << 20;

/// Occupies all of the device's memory except about `left` bytes during its lifetime.
class Ballast {
 public:
  explicit Ballast(std::size_t left) {
    for (std::size_t piece = std::size_t{1} << 36; piece >= 2 * mebibyte; piece /= 2)
      while (cuda::free_memory() >= left + piece) {
        void* memory = nullptr;
        if (cudaMalloc(&memory, piece) != cudaSuccess) break;
        pieces_.push_back(memory);
      }
    cudaGetLastError();
  }
  Ballast(const Ballast&) = delete;
  Ballast& operator=(const Ballast&) = delete;
  ~Ballast() {
    for (void* piece : pieces_) cudaFree(piece);
  }

 private:
  std::vector<void*> pieces_;
};

/// Provides several bodies, each with its result when memory is plentiful.
class ScarceMemory : public ::testing::Test {
 protected:
  void SetUp() override {
    EVODEVO_NEEDS_GPU();
    for (std::uint32_t i = 0; i < 6; ++i) {
      const auto materials = i % 2 == 0 ? paper_materials() : std::vector<Material>{{4000, 0, 0, 0}};
      bodies.push_back(random_body(400 + 31 * i, 20, i, materials));
    }
    expected = robots(bodies.size());
    simulate(*make_cuda_simulator(scene, single_precision), expected, 300, all_records);
  }

  std::vector<Robot> robots(std::size_t count) const {
    std::vector<Robot> robots;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t kind = i % bodies.size();
      robots.emplace_back(bodies[kind], moving_state(bodies[kind], scene, kind));
    }
    return robots;
  }

  /// Simulates `count` robots in one batch, and compares each with the result of its body.
  void expect_the_same(Simulator& simulator, std::size_t count) const {
    std::vector<Robot> found = robots(count);
    simulate(simulator, found, 300, all_records);
    for (std::size_t i = 0; i < count; ++i) {
      SCOPED_TRACE(i);
      ASSERT_EQ(found[i].answer.status, Status::ok) << found[i].answer.reason;
      expect_same_bits(found[i], expected[i % bodies.size()]);
      if (HasFailure()) return;
    }
  }

  const Scene scene = walking_scene();
  std::vector<Body> bodies;
  std::vector<Robot> expected;
};

TEST_F(ScarceMemory, DividesABatch) {
  const Ballast ballast(96 * mebibyte);
  const auto simulator = make_cuda_simulator(scene, single_precision);
  expect_the_same(*simulator, 1024);
  EXPECT_GT(simulator->device_use()->portions, 2u);
}

TEST_F(ScarceMemory, IsSharedByBatchesAtOnce) {
  const Ballast ballast(96 * mebibyte);
  const auto simulator = make_cuda_simulator(scene, single_precision);
  on_own_threads(16, [&](std::size_t) { expect_the_same(*simulator, 64); });
}

TEST_F(ScarceMemory, IsNotKeptFromOthers) {
  // memory that one simulator keeps for its next batch is given to another simulator that needs it
  const auto first = make_cuda_simulator(scene, single_precision),
             second = make_cuda_simulator(scene, single_precision);
  expect_the_same(*first, 512);
  const Ballast ballast(32 * mebibyte);
  expect_the_same(*second, 512);
}

TEST_F(ScarceMemory, ThatIsTooLittleForOneBodyIsNamed) {
  const Body large = test::block(40, {5000, 0.14, 1, 0});
  const auto simulator = make_cuda_simulator({}, single_precision);
  const auto run = [&] {
    State state = test::resting(large, {});
    Task task{.body = &large, .state = &state, .dt = 0.0005, .steps = 3};
    simulator->run({&task, 1}, all_records);
    EXPECT_EQ(task.status, Status::ok) << task.reason;
  };
  {
    const Ballast ballast(24 * mebibyte);
    try {
      run();
      ADD_FAILURE() << "it had memory";
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), ::testing::StartsWith("CUDA: a body of 68921 masses and "));
      EXPECT_THAT(error.what(), ::testing::HasSubstr(" MiB of the GPU's memory"));
      EXPECT_THAT(error.what(), ::testing::HasSubstr("nvidia-smi"));
      EXPECT_THAT(error.what(), ::testing::Not(::testing::HasSubstr("\n")));
    }
  }
  run();
}

TEST_F(ScarceMemory, DividesASearchForNeighbours) {
  std::vector<std::vector<Vec3>> places;
  for (std::uint64_t i = 0; i < 400; ++i) places.push_back(test::random_places(500, i));
  std::vector<PointCloud> clouds;
  for (const auto& of_body : places) clouds.push_back({of_body, 25});
  std::vector<std::size_t> pairs(clouds.size());
  Workers workers(2);
  const auto search = make_cuda_neighbour_search();
  const Ballast ballast(8 * mebibyte);
  search->find(clouds, workers, [&](std::size_t i, std::span<const IndexPair> found) { pairs[i] += found.size(); });
  for (const std::size_t i : {0, 200, 399}) EXPECT_EQ(pairs[i], nearest_pairs(clouds[i].positions, 25).size()) << i;
}

TEST(StreamsAtRest, WaitsForStreamsWhateverIsThrown) {
  EVODEVO_NEEDS_GPU();
  const std::vector<cuda::Stream> streams(3);
  cuda::MirroredMemory memory;
  memory.resize(mebibyte, 1024 * mebibyte);
  const auto fail = [&] {
    const cuda::StreamsAtRest at_rest(streams);
    for (int i = 0; i < 50; ++i)
      for (const cuda::Stream& stream : streams)
        cuda::check(cudaMemsetAsync(memory.device(), i, memory.size(), stream), "clearing");
    throw std::runtime_error("a launch failed");
  };
  EXPECT_THROW(fail(), std::runtime_error);
  for (const cuda::Stream& stream : streams) EXPECT_EQ(cudaStreamQuery(stream), cudaSuccess);
}

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
