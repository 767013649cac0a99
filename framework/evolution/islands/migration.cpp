#include "evolution/islands/migration.hpp"

#include <algorithm>

#include "archive/progress.hpp"
#include "archive/record_check.hpp"
#include "base/philox.hpp"
#include "experiment/islands/neighbours.hpp"

namespace evodevo {
namespace {

Rng stream(const Experiment& island, std::uint32_t generation, std::uint32_t where) {
  return Rng(philox, {static_cast<std::uint64_t>(island.seed), generation, 0, where});
}

bool is_immigrant(const Individual& individual, std::uint32_t generation) {
  return individual.migrated && individual.migrated->island > 0 && individual.born == generation;
}

/// Returns the index of the survivor that leaves its place to an immigrant; none if all of them are immigrants of this
/// generation.
std::optional<std::size_t> displaced(const std::vector<Individual>& survivors, const Experiment& island,
                                     std::uint32_t generation, Rng& rng) {
  const auto is_resident = [&](std::size_t i) { return !is_immigrant(survivors[i], generation); };
  std::vector<std::size_t> ranked = fittest_first(survivors, island.objectives.front().maximise), residents;
  for (std::size_t i = 0; i < survivors.size(); ++i)
    if (is_resident(i)) residents.push_back(i);
  if (residents.empty()) return std::nullopt;
  if (island.islands->replaced == Replaced::random)
    return residents[rng.below(static_cast<std::uint32_t>(residents.size()))];
  for (const std::size_t i : residents)
    if (survivors[i].result.status != Status::ok) return i;
  std::erase_if(ranked, [&](std::size_t i) { return !is_resident(i); });
  return ranked.back();
}

}  // namespace

void Migration::repeat_departures(const Archive& archive, const std::vector<std::uint32_t>& next) {
  const IslandSettings& settings = *island_.islands;
  const std::uint32_t own_next = next.at(static_cast<std::size_t>(island_.island - 1));
  for (const std::int64_t to : destinations_of(island_.island, settings)) {
    const std::uint32_t theirs = next.at(static_cast<std::size_t>(to - 1));
    const std::uint32_t since = theirs > 0 ? theirs - 1 : 0;
    auto emigrants = archive.emigrants_to(to, since);
    for (std::uint32_t generation = since; generation < own_next; ++generation) {
      if (!settings.migrate_after(generation)) continue;
      std::vector<Migrant> migrants;
      for (const std::uint32_t id : emigrants[generation]) {
        ArchivedIndividual left = archive.known_individual(id);
        check_genes(archive, island_, left);
        migrants.push_back({{island_.island, id}, left.origin, std::move(left.genome)});
      }
      exchange_.send({island_.island, to}, generation, std::move(migrants));
    }
  }
  if (is_finished(island_, archive.generations())) end();
}

std::optional<std::vector<Migrant>> Migration::arrivals(std::uint32_t generation, const std::atomic<bool>& stop) {
  if (exchange_.is_abandoned()) return std::nullopt;
  std::vector<Migrant> all;
  if (generation == 0 || !island_.islands->migrate_after(generation - 1)) return all;
  for (const std::int64_t from : sources_of(island_.island, *island_.islands)) {
    std::optional<std::vector<Migrant>> arrived = exchange_.receive({from, island_.island}, generation - 1, stop);
    if (!arrived) return std::nullopt;
    std::ranges::move(*arrived, std::back_inserter(all));
  }
  return all;
}

std::vector<Individual> Migration::claimants(const std::vector<Individual>& everyone, std::uint32_t generation) const {
  std::vector<Individual> claimants;
  if (island_.islands->replaced == Replaced::nobody) return claimants;
  for (const Individual& one : everyone)
    if (is_immigrant(one, generation) && one.result.status == Status::ok) claimants.push_back(one);
  return claimants;
}

void Migration::replace(const std::vector<Individual>& claimants, std::uint32_t generation,
                        std::vector<Individual>& survivors, std::vector<std::uint32_t>& dropped) const {
  Rng rng = stream(island_, generation, rng_stream::replaced);
  for (const Individual& one : claimants) {
    const auto place = std::ranges::find(dropped, one.id);
    if (place == dropped.end()) continue;
    dropped.erase(place);
    if (static_cast<std::int64_t>(survivors.size()) >= island_.population) {
      const std::optional<std::size_t> leaves = displaced(survivors, island_, generation, rng);
      dropped.push_back(leaves ? survivors[*leaves].id : one.id);
      if (!leaves) return;
      survivors.erase(survivors.begin() + static_cast<std::ptrdiff_t>(*leaves));
    }
    survivors.insert(std::ranges::upper_bound(survivors, one.id, {}, &Individual::id), one);
  }
}

std::vector<Emigration> Migration::departures(const std::vector<Individual>& survivors,
                                              std::uint32_t generation) const {
  const IslandSettings& settings = *island_.islands;
  if (!settings.migrate_after(generation)) return {};
  std::vector<std::size_t> chosen = fittest_first(survivors, island_.objectives.front().maximise);
  if (settings.emigrants == Emigrants::random) {
    std::ranges::sort(chosen);
    stream(island_, generation, rng_stream::emigrants).shuffle(chosen);
  }
  chosen.resize(std::min(chosen.size(), static_cast<std::size_t>(settings.migrants)));
  std::ranges::sort(chosen);  // migrants arrive in the order of their birth
  std::vector<Emigration> departures;
  for (const std::int64_t to : destinations_of(island_.island, settings))
    for (const std::size_t i : chosen) departures.push_back({to, survivors[i].id});
  return departures;
}

void Migration::depart(const std::vector<Emigration>& departures, const std::vector<Individual>& survivors,
                       std::uint32_t generation) {
  if (!island_.islands->migrate_after(generation)) return;
  for (const std::int64_t to : destinations_of(island_.island, *island_.islands)) {
    std::vector<Migrant> migrants;
    for (const auto& [island, id] : departures) {
      if (island != to) continue;
      const Individual& one = *std::ranges::find(survivors, id, &Individual::id);
      migrants.push_back({{island_.island, id}, one.origin, one.genome});
    }
    exchange_.send({island_.island, to}, generation, std::move(migrants));
  }
}

}  // namespace evodevo
