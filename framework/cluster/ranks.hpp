// The ranks that a launcher such as mpirun or srun has started.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cluster/channel.hpp"
#include "experiment/experiment.hpp"

namespace evodevo {

/// Keeps the channel to the other ranks open. When it is destroyed on rank 0, the run ends for the others too.
class Ranks {
 public:
  /// Takes part in the channel that the launcher has prepared. If it started only this process, or if there is no
  /// launcher, there are no others. Throws std::runtime_error if there should be others but cannot be: if the library
  /// for MPI is missing, or if the processes do not know of each other.
  static Ranks joined();

  /// This process without others.
  static Ranks alone() { return Ranks(nullptr); }

  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;
  ~Ranks();

  /// Null if there are no others.
  Channel* channel() const { return channel_.get(); }
  bool leads() const { return !channel_ || channel_->rank() == 0; }

 private:
  explicit Ranks(std::shared_ptr<Channel> channel) : channel_(std::move(channel)) {}

  std::shared_ptr<Channel> channel_;
};

/// Whether evodevo was built with MPI, so that a launcher can start several processes.
bool has_mpi();

/// Returns the number of processes that a launcher says it has started together, according to the environment of this
/// process; 1 without a launcher.
int started_processes();

/// Gives this rank its share of its host: its threads, unless the experiment says how many, and its GPUs. Mixed ranks
/// do not share the GPUs that the experiment names, because others may have other devices.
void share_host(Experiment& experiment, const Channel& channel, bool mixed);

/// Returns those of the numbers 0 to count-1 that belong to one of several sharers. Sharers get equally many; if there
/// are fewer numbers than sharers, each gets one, which several share.
std::vector<int> share_of(int count, int sharer, int sharers);

}  // namespace evodevo
