// The migrants on their way between the islands of a run.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <tuple>
#include <vector>

#include "archive/population.hpp"

namespace evodevo {

/// A way from one island to another, both numbered from 1.
struct Route {
  std::int64_t from = 0, to = 0;
  auto operator<=>(const Route&) const = default;
};

/// Carries migrants. Implementations are LocalExchange, for islands in one process, and that of Post
/// (cluster/post.hpp), for several. Several threads may use it.
class Exchange {
 public:
  virtual ~Exchange() = default;

  /// Sends those who emigrate after a generation; it may be nobody. Each route gets one call for each migration.
  virtual void send(const Route& route, std::uint32_t generation, std::vector<Migrant> migrants) = 0;
  /// Says that an island has come to its end and sends nobody any more. Whoever waits for later migrants gets none.
  virtual void end(std::int64_t island) = 0;
  /// Waits for those who emigrated after a generation. Returns nullopt if `stop` is set in the meantime, or abandon()
  /// is called.
  virtual std::optional<std::vector<Migrant>> receive(const Route& route, std::uint32_t generation,
                                                      const std::atomic<bool>& stop) = 0;

  /// Says that an island of this process has failed, so that its other islands stop.
  void abandon() { is_abandoned_ = true; }
  bool is_abandoned() const { return is_abandoned_; }

 private:
  std::atomic<bool> is_abandoned_ = false;
};

class LocalExchange : public Exchange {
 public:
  void send(const Route& route, std::uint32_t generation, std::vector<Migrant> migrants) override;
  void end(std::int64_t island) override;
  std::optional<std::vector<Migrant>> receive(const Route& route, std::uint32_t generation,
                                              const std::atomic<bool>& stop) override;

 private:
  std::mutex mutex_;
  std::condition_variable news_;
  std::map<std::pair<Route, std::uint32_t>, std::vector<Migrant>> under_way_;
  std::set<std::int64_t> ended_;
};

}  // namespace evodevo
