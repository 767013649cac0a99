// A channel of MPI, as a library of its own: the program loads it where a launcher has started several processes, and
// otherwise runs where there is no MPI. It uses point-to-point messages that do not block, and two collective calls:
// one to find the ranks of the same host, one before the ranks leave.
#include <mpi.h>

#include <chrono>
#include <climits>
#include <list>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "cluster/channel.hpp"

namespace evodevo {
namespace {

class MpiChannel final : public Channel {
 public:
  MpiChannel() {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided);
    if (provided < MPI_THREAD_SERIALIZED) throw std::runtime_error("this MPI does not work in programs with threads");
    // a message to a lost rank fails, and ends no other rank
    MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
    MPI_Comm host = MPI_COMM_NULL;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &host);
    MPI_Comm_rank(host, &rank_on_host_);
    MPI_Comm_size(host, &ranks_on_host_);
    MPI_Comm_free(&host);
  }

  int rank() const override { return rank_; }
  int size() const override { return size_; }
  int rank_on_host() const override { return rank_on_host_; }
  int ranks_on_host() const override { return ranks_on_host_; }

  void send(int to, std::string bytes) override {
    if (lost_.contains(to)) return;
    if (bytes.size() > INT_MAX) throw std::runtime_error("a message to rank " + std::to_string(to) + " exceeds 2 GiB");
    Transfer& sending = sending_.emplace_back(to, std::move(bytes));
    if (MPI_Isend(sending.bytes.data(), static_cast<int>(sending.bytes.size()), MPI_BYTE, to, tag, MPI_COMM_WORLD,
                  &sending.request) != MPI_SUCCESS)
      sending_.pop_back();  // rank 0 notices the silence of the other rank
    forget_sent();
  }

  std::optional<Received> receive() override {
    forget_sent();
    begin_receiving();
    std::set<int> unfinished;  // ranks whose next message is still being transferred
    for (auto receiving = receiving_.begin(); receiving != receiving_.end(); ++receiving) {
      if (unfinished.contains(receiving->other)) continue;
      if (is_done(*receiving)) {
        Received received{receiving->other, std::move(receiving->bytes)};
        receiving_.erase(receiving);
        return received;
      }
      unfinished.insert(receiving->other);
    }
    return std::nullopt;
  }

  void give_up(int rank) override { lost_.insert(rank); }
  std::vector<int> given_up() const override { return {lost_.begin(), lost_.end()}; }

  void leave() override {
    if (lost_.empty() && all_leave()) MPI_Finalize();  // which would wait for lost ranks
  }

 private:
  /// A message on its way to or from another rank.
  struct Transfer {
    Transfer(int other_, std::string bytes_) : other(other_), bytes(std::move(bytes_)) {}
    int other;
    std::string bytes;  ///< MPI uses it until the request is complete
    MPI_Request request = MPI_REQUEST_NULL;
  };

  static bool is_done(Transfer& transfer) {
    int done = 0;
    return MPI_Test(&transfer.request, &done, MPI_STATUS_IGNORE) != MPI_SUCCESS || done != 0;
  }

  /// Begins to receive all messages that have been announced.
  void begin_receiving() {
    for (;;) {
      int is_there = 0;
      MPI_Message message = MPI_MESSAGE_NULL;
      MPI_Status status;
      if (MPI_Improbe(MPI_ANY_SOURCE, tag, MPI_COMM_WORLD, &is_there, &message, &status) != MPI_SUCCESS) return;
      if (!is_there) return;
      int count = 0;
      MPI_Get_count(&status, MPI_BYTE, &count);
      Transfer& receiving =
          receiving_.emplace_back(status.MPI_SOURCE, std::string(static_cast<std::size_t>(count), '\0'));
      MPI_Imrecv(receiving.bytes.data(), count, MPI_BYTE, &message, &receiving.request);
    }
  }

  /// Waits until every rank has sent all of its messages. Returns false if that takes too long: rank 0 comes last, but
  /// may verify robots for a while before.
  bool all_leave() {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(rank_ == 0 ? 10 : 3600);
    MPI_Request barrier = MPI_REQUEST_NULL;
    for (int all_are_here = 0; !all_are_here; std::this_thread::sleep_for(std::chrono::milliseconds(1))) {
      while (receive()) {  // nobody needs what comes now, but the others wait until it is taken
      }
      if (sending_.empty() && barrier == MPI_REQUEST_NULL) MPI_Ibarrier(MPI_COMM_WORLD, &barrier);
      if (barrier != MPI_REQUEST_NULL) MPI_Test(&barrier, &all_are_here, MPI_STATUS_IGNORE);
      if (!all_are_here && std::chrono::steady_clock::now() > end) return false;
    }
    return true;
  }

  void forget_sent() { std::erase_if(sending_, is_done); }

  static constexpr int tag = 1;
  int rank_ = 0, size_ = 1, rank_on_host_ = 0, ranks_on_host_ = 1;
  std::list<Transfer> sending_, receiving_;
  std::set<int> lost_;
};

}  // namespace
}  // namespace evodevo

extern "C" __attribute__((visibility("default"))) evodevo::Channel* evodevo_open_mpi_channel() {
  return new evodevo::MpiChannel;
}
