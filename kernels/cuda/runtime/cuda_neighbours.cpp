// The search on a GPU, in portions that fit the GPU's memory.
//
//   clouds ─► pack: points ─► count: number of pairs per cloud ─► write: pairs ─► use(cloud, pairs)
#include "cuda/runtime/cuda_neighbours.hpp"

#include <algorithm>

#include "cuda/layout/packing.hpp"
#include "cuda/layout/point_clouds.hpp"
#include "cuda/runtime/device.hpp"
#include "cuda/runtime/device_resources.hpp"
#include "cuda/runtime/kernels.hpp"
#include "cuda/runtime/launch.hpp"
#include "threads/parallel.hpp"

namespace evodevo {
namespace {

using cuda::DeviceCloud;
using cuda::DevicePair;

static_assert(sizeof(IndexPair) == sizeof(DevicePair));

constexpr const char* source = "cuda/device/neighbours.cu";

/// A cloud with at least one pair to find, and its index among all clouds.
struct Job {
  std::size_t index;
  PointCloud cloud;

  std::size_t points() const { return cloud.positions.size(); }
  std::size_t neighbours() const { return std::min<std::size_t>(cloud.k, points() - 1); }
  /// An upper bound of the number of pairs: every point has neighbours() neighbours, and no pair occurs twice.
  std::size_t most_pairs() const { return std::min(points() * neighbours(), points() * (points() - 1) / 2); }
};

/// The arrays of a portion. The first four are copied from the host; the last two exist only on the device.
struct Arrays {
  explicit Arrays(std::span<const Job> jobs) {
    for (const Job& job : jobs) points += job.points();
    clouds = extent.add<DeviceCloud>(jobs.size());
    for (cuda::Section<double>& axis : axes) axis = extent.add<double>(points);
    input = extent.size();
    reach = extent.add<cuda::Reach>(points);
    first_pair = extent.add<std::uint64_t>(points);
  }

  std::size_t points = 0, input = 0;  // input: bytes
  cuda::Extent extent;
  cuda::Section<DeviceCloud> clouds;
  cuda::Section<double> axes[3];
  cuda::Section<cuda::Reach> reach;
  cuda::Section<std::uint64_t> first_pair;
};

struct Kernels {
  explicit Kernels(cuda::KernelStore& store)
      : find_reach(store.get(source, "evodevo_find_reach", {})),
        count_pairs(store.get(source, "evodevo_count_pairs", {})),
        find_first_pairs(store.get(source, "evodevo_find_first_pairs", {})),
        write_pairs(store.get(source, "evodevo_write_pairs", {})) {}

  cudaKernel_t find_reach, count_pairs, find_first_pairs, write_pairs;
};

/// Clouds that are searched together, in one launch of each kernel.
class Portion {
 public:
  /// Throws OutOfMemory. find() may throw it as well, before its first call of `use`.
  Portion(std::span<const Job> jobs, const Kernels& kernels, cuda::MemoryStore& store, Workers& workers)
      : jobs_(jobs),
        kernels_(kernels),
        workers_(workers),
        layout_(jobs),
        arrays_(store, layout_.extent.size()),
        pairs_(store, most_pairs(jobs) * sizeof(DevicePair)) {}

  /// The memory that a cloud needs, bytes.
  static std::size_t bytes_for(const Job& job) {
    return sizeof(DeviceCloud) + job.points() * (sizeof(Vec3) + sizeof(cuda::Reach) + sizeof(std::uint64_t)) +
           job.most_pairs() * sizeof(DevicePair);
  }

  void find(const NeighbourSearch::Use& use) {
    {
      const cuda::StreamsAtRest at_rest({&stream_, 1});
      pack();
      count();
      write();
    }
    const auto* pairs = reinterpret_cast<const IndexPair*>(pairs_->host());
    workers_.for_each(jobs_.size(), [&](std::size_t i) {
      use(jobs_[i].index, {pairs + clouds()[i].first_pair, clouds()[i].pairs});
    });
  }

 private:
  static std::size_t most_pairs(std::span<const Job> jobs) {
    std::size_t pairs = 0;
    for (const Job& job : jobs) pairs += job.most_pairs();
    return pairs;
  }

  DeviceCloud* clouds() const { return layout_.clouds.in(arrays_->host()); }

  void pack() {
    std::uint32_t first_point = 0;
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
      clouds()[i] = {.first_point = first_point,
                     .points = static_cast<std::uint32_t>(jobs_[i].points()),
                     .neighbours = static_cast<std::uint32_t>(jobs_[i].neighbours())};
      first_point += clouds()[i].points;
    }
    std::byte* host = arrays_->host();
    workers_.for_each(jobs_.size(), [&](std::size_t i) {
      const std::span<const Vec3> positions = jobs_[i].cloud.positions;
      double* const to[] = {layout_.axes[0].in(host) + clouds()[i].first_point,
                            layout_.axes[1].in(host) + clouds()[i].first_point,
                            layout_.axes[2].in(host) + clouds()[i].first_point};
      for (std::size_t p = 0; p < positions.size(); ++p)
        to[0][p] = positions[p].x, to[1][p] = positions[p].y, to[2][p] = positions[p].z;
      // rounding is monotonic, so that no computed distance within the box is larger than this
      const Box box = bounding_box(positions);
      clouds()[i].largest_square = dot(box.high - box.low, box.high - box.low);
    });
  }

  /// The description of the portion for the kernels.
  cuda::DeviceClouds description() const {
    std::byte* device = arrays_->device();
    return {.clouds = layout_.clouds.in(device),
            .x = layout_.axes[0].in(device),
            .y = layout_.axes[1].in(device),
            .z = layout_.axes[2].in(device),
            .reach = layout_.reach.in(device),
            .first_pair = layout_.first_pair.in(device),
            .count = static_cast<std::uint32_t>(jobs_.size()),
            .points = static_cast<std::uint32_t>(layout_.points)};
  }

  /// The number of blocks with one warp for each of `items`.
  static dim3 blocks_for(std::size_t items) {
    constexpr std::size_t warps = cuda::search_threads / 32;
    return dim3(static_cast<unsigned>((items + warps - 1) / warps));
  }

  template <class... Arguments>
  void launch(cudaKernel_t kernel, std::size_t warps, Arguments... arguments) {
    cuda::launch(kernel, blocks_for(warps), cuda::search_threads, 0, stream_, description(), arguments...);
  }

  void copy_clouds(cudaMemcpyKind direction) {
    const cuda::MirroredMemory& memory = *arrays_;
    const bool up = direction == cudaMemcpyHostToDevice;
    cuda::check(cudaMemcpyAsync(layout_.clouds.in(up ? memory.device() : memory.host()),
                                layout_.clouds.in(up ? memory.host() : memory.device()),
                                jobs_.size() * sizeof(DeviceCloud), direction, stream_),
                "copying point clouds");
  }

  /// Finds the reach of every point and the number of pairs of every cloud.
  void count() {
    cuda::check(cudaMemcpyAsync(arrays_->device(), arrays_->host(), layout_.input, cudaMemcpyHostToDevice, stream_),
                "copying points to the GPU");
    launch(kernels_.find_reach, layout_.points);
    launch(kernels_.count_pairs, layout_.points);
    launch(kernels_.find_first_pairs, jobs_.size());
    copy_clouds(cudaMemcpyDeviceToHost);
    cuda::wait_for(stream_, "finding neighbours on the GPU");
  }

  /// Writes all pairs, one cloud after the other, and copies them to the host.
  void write() {
    std::uint64_t pairs = 0;
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
      clouds()[i].first_pair = pairs;
      pairs += clouds()[i].pairs;
    }
    copy_clouds(cudaMemcpyHostToDevice);
    launch(kernels_.write_pairs, layout_.points, reinterpret_cast<DevicePair*>(pairs_->device()));
    cuda::check(
        cudaMemcpyAsync(pairs_->host(), pairs_->device(), pairs * sizeof(DevicePair), cudaMemcpyDeviceToHost, stream_),
        "copying pairs from the GPU");
    cuda::wait_for(stream_, "finding neighbours on the GPU");
  }

  std::span<const Job> jobs_;
  const Kernels& kernels_;
  Workers& workers_;
  Arrays layout_;
  cuda::MemoryStore::Loan arrays_, pairs_;
  cuda::Stream stream_;
};

class CudaNeighbourSearch final : public NeighbourSearch {
 public:
  CudaNeighbourSearch(const cuda::Device& device, std::size_t memory)
      : device_(device), largest_portion_(memory), kernels_(*store_) {}

  void find(std::span<const PointCloud> clouds, Workers& workers, const Use& use) override {
    cuda::work_on(device_);
    std::vector<Job> jobs;
    std::vector<std::size_t> without_pairs;
    for (std::size_t i = 0; i < clouds.size(); ++i) {
      if (clouds[i].positions.size() < 2 || clouds[i].k == 0)
        without_pairs.push_back(i);
      else
        jobs.push_back({i, clouds[i]});
    }
    workers.for_each(without_pairs.size(), [&](std::size_t i) { use(without_pairs[i], {}); });
    if (jobs.empty()) return;
    for (std::span<const Job> left = jobs; !left.empty();) {
      const auto attempt = [&](std::size_t count) {
        Portion(left.first(count), kernels_, resources_->memory, workers).find(use);
      };
      left = left.subspan(resources_->memory.with_fewer(portion_from(left), attempt));
    }
  }

 private:
  /// The number of jobs, from the first one on, that form a portion; at least one.
  std::size_t portion_from(std::span<const Job> jobs) const {
    std::size_t bytes = 0;
    for (std::size_t count = 0; count < jobs.size(); ++count) {
      bytes += Portion::bytes_for(jobs[count]);
      if (bytes > largest_portion_) return std::max<std::size_t>(count, 1);
    }
    return jobs.size();
  }

  cuda::Device device_;
  std::size_t largest_portion_;  // bytes
  std::shared_ptr<cuda::KernelStore> store_ = cuda::KernelStore::of_architecture(device_.architecture);
  Kernels kernels_;
  std::shared_ptr<cuda::DeviceResources> resources_ = cuda::DeviceResources::of(device_);
};

}  // namespace

std::unique_ptr<NeighbourSearch> make_cuda_neighbour_search(std::size_t memory) {
  return make_cuda_neighbour_search(cuda::current_device(), memory);
}

std::unique_ptr<NeighbourSearch> make_cuda_neighbour_search(const cuda::Device& device, std::size_t memory) {
  cuda::work_on(device);
  return std::make_unique<CudaNeighbourSearch>(device, memory);
}

}  // namespace evodevo
