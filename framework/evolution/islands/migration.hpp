// The part of an island in migration: who leaves it, who arrives, and whose places immigrants take.
//
//   generation g: select ─► depart ─► Exchange ─► generation g + 1 of the neighbour: arrivals ─► breed
#pragma once

#include <atomic>
#include <optional>
#include <vector>

#include "archive/archive.hpp"
#include "evolution/islands/exchange.hpp"

namespace evodevo {

/// Migration to and from one island. Experiment and exchange must outlive it.
class Migration {
 public:
  Migration(const Experiment& island, Exchange& exchange) : island_(island), exchange_(exchange) {}

  /// Sends those whom the island has sent before, according to its archive, to neighbours that have not received them:
  /// `next` has the next generation of each island, in the order of their numbers. Says that the island has ended if
  /// its run is finished.
  void repeat_departures(const Archive& archive, const std::vector<std::uint32_t>& next);

  /// Waits for the migrants that arrive in a generation, and returns them in the order of the islands from which they
  /// come; none if nobody migrates then. Returns nullopt if `stop` is set in the meantime, or the exchange is
  /// abandoned.
  std::optional<std::vector<Migrant>> arrivals(std::uint32_t generation, const std::atomic<bool>& stop);

  /// Returns copies of the immigrants of a generation that have a fitness, if they may take the places of others, as
  /// IslandSettings::replaced asks.
  std::vector<Individual> claimants(const std::vector<Individual>& everyone, std::uint32_t generation) const;
  /// Lets those claimants that selection has dropped take the places of survivors that are no immigrants of this
  /// generation. Updates the survivors, who are in the order of birth, and the ids in `dropped`.
  void replace(const std::vector<Individual>& claimants, std::uint32_t generation, std::vector<Individual>& survivors,
               std::vector<std::uint32_t>& dropped) const;

  /// Returns who leaves after a generation; nobody if there is no migration after it.
  std::vector<Emigration> departures(const std::vector<Individual>& survivors, std::uint32_t generation) const;
  /// Sends them. To be called when their generation has been written, or is being written.
  void depart(const std::vector<Emigration>& departures, const std::vector<Individual>& survivors,
              std::uint32_t generation);
  /// Says that the run of the island is finished.
  void end() { exchange_.end(island_.island); }

 private:
  const Experiment& island_;
  Exchange& exchange_;
};

}  // namespace evodevo
