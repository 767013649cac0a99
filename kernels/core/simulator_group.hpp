// Several simulators on equal devices that work as one.
//
//   run(tasks) ─► Backlog: the member with the least work before it ─► its run(tasks)
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "core/simulator.hpp"

namespace evodevo {

/// The work that the members of a group have been given and have not finished. Members that finish their work sooner
/// get more of it, however fast each of them is. Several threads may use a backlog.
class Backlog {
 public:
  explicit Backlog(std::size_t members) : work_(members, 0) {}

  /// A piece of work: it is part of the backlog of the member with the least work until it is destroyed.
  class Claim {
   public:
    /// `work` is the size of the piece, in any unit that is the same for all pieces.
    Claim(Backlog& backlog, std::uint64_t work) : backlog_(backlog), work_(work), member_(backlog.add(work)) {}
    Claim(const Claim&) = delete;
    Claim& operator=(const Claim&) = delete;
    ~Claim() { backlog_.remove(member_, work_); }

    /// The index of the member that shall do the work.
    std::size_t member() const { return member_; }

   private:
    Backlog& backlog_;
    std::uint64_t work_;
    std::size_t member_;
  };

 private:
  std::size_t add(std::uint64_t work);
  void remove(std::size_t member, std::uint64_t work);

  std::mutex mutex_;
  std::vector<std::uint64_t> work_;
};

/// Makes one simulator of several. Each batch is simulated by one of them, and several batches by several at once.
/// The members must be at least one, and must give equal results: devices of one type, with the same scene and
/// stepping, that share their workers. Groups on the same devices should have the same backlog, with as many members;
/// null: one of its own.
std::unique_ptr<Simulator> make_simulator_group(std::vector<std::unique_ptr<Simulator>> members,
                                                std::shared_ptr<Backlog> backlog = nullptr);

}  // namespace evodevo
