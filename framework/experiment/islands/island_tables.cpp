#include "experiment/islands/island_tables.hpp"

#include <set>

#include "base/philox.hpp"
#include "experiment/islands/neighbours.hpp"
#include "experiment/tables/declarations.hpp"

namespace evodevo {
namespace {

constexpr std::array<const char*, 3> own_operators{"mutation", "crossover", "selection"};

/// Reports what keeps the islands from exchanging migrants.
void check_migration(const TomlReader& t, const IslandSettings& islands, const Settings& settings) {
  if (islands.topology == Topology::torus && torus_grid(islands.count).rows == 1)
    return t.report("topology",
                    "a torus has rows and columns, and " + std::to_string(islands.count) +
                        " islands make one row only; choose a count that is no prime number, or the topology \"ring\"");
  const std::int64_t sources = most_sources(islands), places = settings.newborns() - settings.random_individuals;
  if (sources * islands.migrants > places)
    t.report("migrants",
             "up to " + std::to_string(sources * islands.migrants) + " immigrants (from " + std::to_string(sources) +
                 (sources == 1 ? " island" : " islands") + ") would be born in one generation, whose newborns are " +
                 std::to_string(settings.newborns()) + ", of which " + std::to_string(settings.random_individuals) +
                 " are random individuals; expected at most " + std::to_string(places) +
                 "; lower this key, raise population or children in [experiment], or choose another topology",
             {"experiment", "islands.topology", "islands.count"});
}

/// Returns the part of a whole that belongs to an island, numbered from 1; the first ones get what cannot be divided.
std::int64_t part_of(std::int64_t whole, std::int64_t count, std::int64_t island) {
  return whole / count + (island <= whole % count ? 1 : 0);
}

const toml::table* table_of_island(const toml::table& root, std::int64_t island) {
  const toml::array* tables = root["island"].as_array();
  if (tables == nullptr) return nullptr;
  for (const toml::node& node : *tables)
    if (const toml::table* table = node.as_table(); table != nullptr && (*table)["number"].value<double>() == island)
      return table;
  return nullptr;
}

}  // namespace

void read_island_settings(TomlReader& top, Settings& settings) {
  read_table(top, "islands", false, [&](TomlReader& t) {
    IslandSettings islands;
    declare(t, islands);
    t.stop_if_wrong();
    check_migration(t, islands, settings);
    settings.islands = islands;
  });
}

void check_island_tables(TomlReader& top, const Settings& settings) {
  std::set<std::int64_t> numbers;
  const std::int64_t count = settings.islands ? settings.islands->count : 0;
  visit_tables(top, "island", most_islands, {}, [&](TomlReader& t) {
    t.expect({"number", "seed", "mutation", "crossover", "selection"});
    std::int64_t number = 0;
    declare_island_number(t, number);
    if (number == 0) return t.report("number", "is missing; say which island this table changes");
    std::optional<double> seed;
    declare_island(t, seed);
    if (seed && *seed != static_cast<double>(static_cast<std::int64_t>(*seed)))
      t.report("seed", "expected a whole number");
    if (count == 0)
      return t.report("number", "there is no table [islands]; add one, or remove this table", {"islands"});
    if (number > count) t.report("number", "expected at most the count in [islands], " + std::to_string(count));
    if (!numbers.insert(number).second)
      t.report("number", "another table is of the same island; join the two, or change this number");
  });
}

std::int64_t island_seed(std::int64_t run_seed, std::int64_t island) {
  Rng rng(philox, {static_cast<std::uint64_t>(run_seed), 0, static_cast<std::uint32_t>(island), rng_stream::island});
  constexpr std::uint32_t half = 1u << 26;
  const std::int64_t high = rng.below(half), low = rng.below(2 * half);
  return high << 27 | low;
}

std::vector<toml::table> island_roots(const toml::table& root, const Settings& settings) {
  std::vector<toml::table> roots;
  const std::int64_t count = settings.islands.value().count;
  if (settings.evaluations < count)
    TomlReader(root, "").fail("islands", "the " + std::to_string(settings.evaluations) +
                                             " evaluations of the run are divided among " + std::to_string(count) +
                                             " islands; raise experiment.evaluations, or lower islands.count");
  for (std::int64_t island = 1; island <= count; ++island) {
    toml::table one = root;
    const toml::table* own = table_of_island(root, island);
    const std::optional<double> seed = own ? (*own)["seed"].value<double>() : std::nullopt;
    toml::table& run = *one["experiment"].as_table();
    run.insert_or_assign("seed", seed ? static_cast<std::int64_t>(*seed) : island_seed(settings.seed, island));
    if (!one.contains("development")) one.insert("development", toml::table());
    one["development"].as_table()->insert_or_assign("seed", settings.development.seed);
    run.insert_or_assign("evaluations", part_of(settings.evaluations, count, island));
    if (settings.spring_evaluations > 0)
      run.insert_or_assign("spring_evaluations", settings.spring_evaluations / static_cast<double>(count));
    for (const char* name : own_operators)
      if (own && own->contains(name)) (*own)[name].visit([&](const auto& node) { one.insert_or_assign(name, node); });
    one.erase("island");
    roots.push_back(std::move(one));
  }
  return roots;
}

}  // namespace evodevo
