#include "evolution/islands/exchange.hpp"

#include <chrono>
#include <utility>

namespace evodevo {
namespace {

constexpr std::chrono::milliseconds between_looks{20};  // at `stop`, which a signal handler sets

}  // namespace

void LocalExchange::send(const Route& route, std::uint32_t generation, std::vector<Migrant> migrants) {
  const std::lock_guard lock(mutex_);
  under_way_[{route, generation}] = std::move(migrants);
  news_.notify_all();
}

void LocalExchange::end(std::int64_t island) {
  const std::lock_guard lock(mutex_);
  ended_.insert(island);
  news_.notify_all();
}

std::optional<std::vector<Migrant>> LocalExchange::receive(const Route& route, std::uint32_t generation,
                                                           const std::atomic<bool>& stop) {
  std::unique_lock lock(mutex_);
  for (;; news_.wait_for(lock, between_looks)) {
    if (auto arrived = under_way_.extract({route, generation}); !arrived.empty()) return std::move(arrived.mapped());
    if (ended_.contains(route.from)) return std::vector<Migrant>();
    if (stop || is_abandoned()) return std::nullopt;
  }
}

}  // namespace evodevo
