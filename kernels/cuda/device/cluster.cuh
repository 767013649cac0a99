// A cluster of thread blocks that simulate the parts of one body on neighbouring multiprocessors, and write to each
// other's shared memory.
//
// In every pass, each block sends the positions of some of its masses to the halos of others. Nobody waits for a
// barrier of the whole cluster: a block counts the bytes that have arrived, and only its warps with cut springs wait
// for them. A halo has two sets, for even and odd passes. A block that has received the positions for a pass knows that
// the senders have finished the pass before; so it may send those for the next pass to the set that was read then. That
// is why parts must be neighbours of each other: each needs masses of the other.
#pragma once

#include "cuda/device/springs.cuh"

namespace evodevo::cuda::cluster {

constexpr unsigned halo_set = halo_set_bytes<Number, dashpots>;

__device__ __forceinline__ unsigned rank() {
  unsigned rank;
  asm("mov.u32 %0, %%cluster_ctarank;" : "=r"(rank));
  return rank;
}

__device__ __forceinline__ unsigned size() {
  unsigned size;
  asm("mov.u32 %0, %%cluster_nctarank;" : "=r"(size));
  return size;
}

/// Waits for all threads of the cluster. Afterwards, all see what each has written before.
__device__ __forceinline__ void synchronise() {
  __syncwarp();
  asm volatile("barrier.cluster.arrive.release.aligned;\nbarrier.cluster.wait.acquire.aligned;" ::: "memory");
}

__device__ __forceinline__ unsigned address(const void* variable) {
  return static_cast<unsigned>(__cvta_generic_to_shared(variable));
}

/// The address in block `rank` of what has an address in this block.
__device__ __forceinline__ unsigned address_in(unsigned rank, unsigned here) {
  unsigned there;
  asm("mapa.shared::cluster.u32 %0, %1, %2;" : "=r"(there) : "r"(here), "r"(rank));
  return there;
}

__device__ __forceinline__ double read(unsigned address) {
  double value;
  asm volatile("ld.shared::cluster.f64 %0, [%1];" : "=d"(value) : "r"(address) : "memory");
  return value;
}

/// Sends a number to another block, and counts its bytes there.
__device__ __forceinline__ void send(unsigned to, float number, unsigned counter) {
  asm volatile("st.async.shared::cluster.mbarrier::complete_tx::bytes.b32 [%0], %1, [%2];" ::"r"(to),
               "r"(__float_as_uint(number)), "r"(counter)
               : "memory");
}

__device__ __forceinline__ void send(unsigned to, double number, unsigned counter) {
  asm volatile("st.async.shared::cluster.mbarrier::complete_tx::bytes.b64 [%0], %1, [%2];" ::"r"(to),
               "l"(__double_as_longlong(number)), "r"(counter)
               : "memory");
}

__device__ __forceinline__ void send(unsigned to, const Vector& vector, unsigned counter) {
  send(to, vector.x, counter);
  send(to + plane_bytes<Number>, vector.y, counter);
  send(to + 2 * plane_bytes<Number>, vector.z, counter);
}

/// Counts the bytes that arrive in each set of this block's halo (an mbarrier of PTX). A phase ends when as many bytes
/// as expected have arrived.
__shared__ std::uint64_t counters[2];

__device__ __forceinline__ void make_counters() {
  for (const std::uint64_t& counter : counters)
    asm volatile("mbarrier.init.shared::cta.b64 [%0], 1;" ::"r"(address(&counter)) : "memory");
  asm volatile("fence.mbarrier_init.release.cluster;" ::: "memory");
}

/// Begins a phase, in which this many bytes arrive.
__device__ __forceinline__ void expect(unsigned counter, unsigned bytes) {
  asm volatile("mbarrier.arrive.expect_tx.shared::cta.b64 _, [%0], %1;" ::"r"(counter), "r"(bytes) : "memory");
}

/// Waits until the present phase, whose number is even or odd, has ended. What has arrived is in shared memory, for
/// which acquiring at the scope of the block suffices; at that of the cluster, the cache of the device's memory would
/// be emptied as well.
__device__ __forceinline__ void wait(unsigned counter, unsigned odd) {
  unsigned ended;
  do {
    asm volatile(
        "{ .reg .pred ended;\n"
        "mbarrier.try_wait.parity.shared::cta.b64 ended, [%1], %2;\n"
        "selp.u32 %0, 1, 0, ended; }"
        : "=r"(ended)
        : "r"(counter), "r"(odd)
        : "memory");
  } while (ended == 0);
}

__shared__ double of_block[8];    // values of this block, for join_blocks()
__shared__ double of_cluster[8];  // its results

/// Joins each of `count` values in of_block over all blocks, in the order of their ranks. All threads may then read the
/// results in of_cluster.
template <class Join>
__device__ __forceinline__ void join_blocks(unsigned count, Join join) {
  synchronise();
  if (threadIdx.x < count) {
    const auto of = [&](unsigned block) { return read(address_in(block, address(&of_block[threadIdx.x]))); };
    double result = of(0);
    for (unsigned block = 1; block < size(); ++block) result = join(result, of(block));
    of_cluster[threadIdx.x] = result;
  }
  synchronise();
}

}  // namespace evodevo::cuda::cluster

namespace evodevo::cuda {

/// The exchange of positions between the parts of a body.
struct Halo {
  unsigned sent = 0;       // how often positions have been sent
  HaloCopy first{};        // what the thread sends first
  bool has_first = false;  // whether it sends anything
  bool has_more = false;   // whether it sends more than that

  /// The offset of the set with the latest positions.
  __device__ __forceinline__ unsigned set() const { return sent % 2 == 0 ? cluster::halo_set : 0; }

  /// Sends the masses that other blocks need, by the warps with cut springs. All threads call this.
  template <Kind kind>
  __device__ __forceinline__ void send(const Body& body) {
    const unsigned counter = cluster::address(&cluster::counters[sent % 2]);
    ++sent;
    if constexpr (kind == Kind::cut) {
      if (has_first) send(first, counter);
      if (has_more)
        for (unsigned i = thread(body) + body.cut_warps * lanes; i < body.copies; i += body.cut_warps * lanes)
          send({__ldg(&body.halo_copies[i].from), __ldg(&body.halo_copies[i].to)}, counter);
      if (thread(body) == 0) cluster::expect(counter, body.halo_masses * (cluster::halo_set / lanes));
    }
  }

  /// Waits for the positions that other blocks have sent; called by the warps with cut springs.
  __device__ __forceinline__ void wait() const {
    cluster::wait(cluster::address(&cluster::counters[(sent - 1) % 2]), (sent - 1) / 2 % 2);
  }

  /// Clears both sets and sends the first positions when all blocks have done so.
  __device__ __forceinline__ void begin(const Body& body, const Share& share) {
    for (unsigned i = threadIdx.x; i < body.halo_groups * (2 * cluster::halo_set / sizeof(Number)); i += blockDim.x)
      on_chip<Number>(body.halo_offset + i * sizeof(Number)) = 0;
    if (threadIdx.x == 0) cluster::make_counters();
    if (share.kind == Kind::cut) {
      has_first = thread(body) < body.copies;
      has_more = thread(body) + body.cut_warps * lanes < body.copies;
      if (has_first) first = body.halo_copies[thread(body)];
    }
    cluster::synchronise();
    if (share.kind == Kind::cut)
      send<Kind::cut>(body);
    else
      send<Kind::none>(body);
  }

 private:
  /// The number of this thread among those of the warps with cut springs.
  static __device__ __forceinline__ unsigned thread(const Body& body) { return threadIdx.x - body.warps * lanes; }

  __device__ __forceinline__ void send(HaloCopy copy, unsigned counter) const {
    const unsigned rank = copy.to >> halo_rank_shift, offset = copy.to & ((1u << halo_rank_shift) - 1);
    const unsigned to = cluster::address_in(rank, cluster::address(chip + offset)) + set();
    const unsigned counter_there = cluster::address_in(rank, counter);
    cluster::send(to, position_at(copy.from), counter_there);
    if constexpr (dashpots) cluster::send(to + 3 * plane, velocity_at(copy.from), counter_there);
  }
};

}  // namespace evodevo::cuda
