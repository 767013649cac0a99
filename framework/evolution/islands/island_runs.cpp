#include "evolution/islands/island_runs.hpp"

#include <exception>
#include <thread>

#include "evolution/islands/migration.hpp"

namespace evodevo {
namespace {

/// Calls `call` with each index, all at the same time, because islands wait for each other. If the system refuses a
/// thread, calls `abandon`, so that those that have begun end, and throws.
template <class Call, class Abandon>
void at_the_same_time(std::size_t count, const Call& call, const Abandon& abandon) {
  if (count == 1) return call(0);
  std::vector<std::jthread> threads;
  try {
    for (std::size_t i = 0; i < count; ++i) threads.emplace_back([&call, i] { call(i); });
  } catch (...) {
    abandon();
    throw;
  }
}

}  // namespace

std::vector<TimeSpent> evolve(std::vector<IslandRun>& islands, Exchange& exchange,
                              const std::vector<std::uint32_t>& next, const std::atomic<bool>& stop) {
  std::vector<Migration> migrations;
  for (const IslandRun& island : islands) migrations.emplace_back(island.experiment, exchange);
  for (std::size_t i = 0; i < islands.size(); ++i) migrations[i].repeat_departures(islands[i].archive, next);
  std::vector<TimeSpent> times(islands.size());
  std::vector<std::exception_ptr> failures(islands.size());
  const auto run = [&](std::size_t i) {
    const auto& [experiment, archive, evaluator, observer] = islands[i];
    try {
      times[i] = evolve(experiment, evaluator, archive, stop, observer, &migrations[i]);
    } catch (...) {
      failures[i] = std::current_exception();
      exchange.abandon();
    }
  };
  at_the_same_time(islands.size(), run, [&] { exchange.abandon(); });
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
  return times;
}

}  // namespace evodevo
