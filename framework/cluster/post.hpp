// The post of the first rank of a group: it sorts what other ranks send to it.
//
//   Channel ─► a thread of its own ─► messages of the group's ranks ─► group(), for the Farm
//                                  ─► Migrants, LastMigrants        ─► exchange()
//                                  ─► Generation, Done, Failure     ─► rank 0: who is done, and why a group failed
//                                  ─► stop, End                     ─► `stop`
#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>

#include "cluster/groups.hpp"
#include "cluster/messages.hpp"
#include "evolution/islands/exchange.hpp"

namespace evodevo {

struct PostOptions {
  std::chrono::seconds patience{30};                   ///< of rank 0 with first ranks that say nothing
  std::chrono::seconds patience_with_leader{10 * 60};  ///< of first ranks with rank 0
};

/// While it exists, the channel belongs to it. Channel and `stop` must outlive it.
class Post {
 public:
  using OnGeneration = std::function<void(std::int64_t island, const Summary& summary)>;

  /// Sets `stop` if rank 0 says so or falls silent or, on rank 0, if another group or `on_generation` fails. If `stop`
  /// is set on rank 0, tells the others. Calls `on_generation` on rank 0 for the generations of other groups.
  Post(Channel& channel, const Groups& groups, std::atomic<bool>& stop, OnGeneration on_generation,
       const PostOptions& options = {});
  Post(const Post&) = delete;
  Post& operator=(const Post&) = delete;
  ~Post() = default;

  /// The channel of the ranks of this group.
  Channel& group() { return group_; }
  /// Carries migrants between all islands of the run.
  Exchange& exchange() { return exchange_; }

  /// Tells rank 0 that an island of this group has completed a generation.
  void tell_generation(std::int64_t island, const Summary& summary);
  /// Tells rank 0 that this group has ended its work, and waits until rank 0 ends the run.
  void done();
  /// Tells rank 0 why this group cannot go on, and waits until rank 0 ends the run.
  void fail(const std::exception& error);
  /// On rank 0: waits until all other groups have ended their work. Returns why the first one failed, if one has.
  std::optional<std::string> others_done();

 private:
  using Clock = std::chrono::steady_clock;

  /// The channel of all ranks, which several threads use.
  class Shared final : public Channel {
   public:
    explicit Shared(Channel& channel) : channel_(channel) {}
    int rank() const override { return channel_.rank(); }
    int size() const override { return channel_.size(); }
    int rank_on_host() const override { return channel_.rank_on_host(); }
    int ranks_on_host() const override { return channel_.ranks_on_host(); }
    void send(int to, std::string bytes) override;
    /// Returns a message of the group.
    std::optional<Received> receive() override;
    void give_up(int rank) override;
    std::vector<int> given_up() const override;
    void leave() override {}
    /// Returns a message of any rank.
    std::optional<Received> receive_any();
    void put_in_box(Received received);

   private:
    Channel& channel_;
    mutable std::mutex mutex_;
    std::deque<Received> box_;
  };

  class GroupsExchange final : public LocalExchange {
   public:
    explicit GroupsExchange(Post& post) : post_(post) {}
    void send(const Route& route, std::uint32_t generation, std::vector<Migrant> migrants) override;
    void end(std::int64_t island) override;

   private:
    Post& post_;
  };

  bool leads() const { return shared_.rank() == 0; }
  void work(const std::stop_token& ending);
  void sort(Received received);
  void take(int from, const std::string& bytes);
  void beat();
  void check_silence();
  void note_failure(const std::string& reason);
  void take_failure(int rank, const std::string& reason);
  void tell_first_ranks(const std::string& bytes);
  void wait_for_end();

  Groups groups_;
  Shared shared_;
  GroupChannel group_;
  GroupsExchange exchange_;
  std::atomic<bool>& stop_;
  OnGeneration on_generation_;
  PostOptions options_;
  std::map<int, Clock::time_point> heard_;  ///< first ranks of other groups, and when they said something
  Clock::time_point next_beat_ = Clock::now(), heard_leader_ = Clock::now();
  bool told_stop_ = false;
  std::mutex mutex_;     ///< of the members below
  std::set<int> ended_;  ///< first ranks whose groups have ended their work
  std::optional<std::string> failure_;
  std::atomic<bool> is_over_ = false;  ///< rank 0 has ended the run
  std::jthread thread_;                ///< the last member, because it uses the others
};

}  // namespace evodevo
