// Messages between the processes of a run. MPI carries them (mpi/mpi_channel.cpp); tests use threads of one process.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace evodevo {

constexpr std::chrono::microseconds between_looks{500};  ///< at the channel
constexpr std::chrono::seconds between_beats{1};         ///< with which a rank says that it is there
constexpr int setup_patience = 4;  ///< times the patience, since ranks may load operators from a slow file system

/// A message, and the rank that sent it.
struct Received {
  int from = 0;
  std::string bytes;
};

/// Joins the processes of a run, which are called ranks and are numbered from 0. The rank 0 leads. Messages from one
/// rank to another arrive in the order in which they were sent. Calls come from one thread at a time, and none of them
/// waits for another rank except leave().
class Channel {
 public:
  virtual ~Channel() = default;

  virtual int rank() const = 0;
  virtual int size() const = 0;
  /// The number of a rank of this channel among all ranks of the run, by which messages name it.
  virtual int number_in_run(int rank) const { return rank; }
  /// The number of this rank among the ranks on its host, from 0, and their number.
  virtual int rank_on_host() const = 0;
  virtual int ranks_on_host() const = 0;

  virtual void send(int to, std::string bytes) = 0;
  virtual std::optional<Received> receive() = 0;
  /// Treats a rank as lost: what is sent to it later is dropped, and nobody waits for it.
  virtual void give_up(int rank) = 0;
  virtual std::vector<int> given_up() const = 0;
  /// Ends the channel after all of its messages have been delivered; every rank calls this last. Does not wait if a
  /// rank has been given up.
  virtual void leave() = 0;
};

}  // namespace evodevo
