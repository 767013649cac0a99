// Species of similar genomes that share their fitness (NEAT: Stanley and Miikkulainen 2002).
#include <map>
#include <queue>
#include <set>

#include "evodevo/helpers/rows.hpp"
#include "evodevo/helpers/selection/homology.hpp"
#include "evodevo/helpers/selection/memory.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Candidate;
using evodevo::SelectionContext;
using Numbers = std::vector<std::uint32_t>;

/// An individual belongs to the species whose best member of the generation before has the most similar genome, or
/// founds a new one if none is similar enough. Two species become one when these members are similar. The worth of an
/// individual is its first score, counted from 0 or from the lowest one if that is below 0, divided by the number of
/// members of its species: so no species takes over, and new ones have time to improve (fitness sharing: Goldberg and
/// Richardson 1987). Parents are drawn in proportion to their worth, and their mates from the same species. Survivors
/// are chosen one by one, and for their worth, only those members count that were chosen before. The memory holds the
/// species of the living.
class SpeciesSelection final : public evodevo::Selection {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.real(threshold_, "threshold", {0, 10, "1"},
           "Difference between genomes up to which they belong to one species: share of blocks without a homologous "
           "one, plus the mean difference between homologous genes relative to their ranges.");
    p.real(weight_, "gene_weight", {0, 100, "1"}, "Weight of the differences between homologous genes.");
  }

  std::vector<evodevo::NoteTitle> notes() const override { return {{.name = "species", .is_label = true}}; }
  std::vector<std::string> memory() const override { return {"ids", "species", "next"}; }

  std::vector<evodevo::Couple> parents(const SelectionContext& context, std::uint32_t count,
                                       evodevo::Rng& rng) const override {
    const Known known = Known::in(context.memory);
    const auto pool = breeding_rows(context.rows);
    std::map<std::uint32_t, Numbers> members;  // positions in the pool
    for (std::uint32_t i = 0; i < pool.size(); ++i) members[known.species_of(context.rows[pool[i]])].push_back(i);
    const auto worth = shares(context.rows, pool);
    std::vector<double> sums{0};
    for (std::uint32_t i = 0; i < pool.size(); ++i)
      sums.push_back(sums.back() +
                     worth[i] / static_cast<double>(members[known.species_of(context.rows[pool[i]])].size()));

    std::vector<evodevo::Couple> couples;
    for (std::uint32_t i = 0; i < count && !pool.empty(); ++i) {
      const auto found = std::upper_bound(sums.begin() + 1, sums.end() - 1, rng.uniform() * sums.back());
      const auto parent = static_cast<std::uint32_t>(found - sums.begin() - 1);
      Numbers others = members[known.species_of(context.rows[pool[parent]])];
      if (others.size() == 1) {  // the last of its species mates with anyone
        others.resize(pool.size());
        std::iota(others.begin(), others.end(), 0u);
      }
      if (others.size() > 1) std::erase(others, parent);
      couples.push_back({pool[parent], pool[others[rng.below(static_cast<std::uint32_t>(others.size()))]]});
    }
    return couples;
  }

  evodevo::Survival survivors(const SelectionContext& context, std::uint32_t population, evodevo::Rng&) const override {
    Known known = Known::in(context.memory);
    const auto order = breeding_rows(context.rows);
    const Numbers species = classified(context, order, known);
    evodevo::Survival survival;
    for (std::uint32_t i = 0; i < order.size(); ++i)
      if (context.rows[order[i]].ok()) survival.notes.push_back({order[i], 0, static_cast<double>(species[i])});

    Known living{.next = known.next};
    for (const std::uint32_t i : chosen(shares(context.rows, order), species, population)) {
      survival.rows.push_back(order[i]);
      living.species[context.rows[order[i]].id] = species[i];
    }
    survival.memory = living.memory();
    return survival;
  }

 private:
  /// The memory: the species of individuals by their ids, and the number of the next new species.
  struct Known {
    static Known in(const evodevo::SelectionMemory& memory) {
      Known known;
      if (memory.empty()) return known;
      const Numbers next = whole_numbers(memory, "next"), ids = whole_numbers(memory, "ids"),
                    numbers = whole_numbers(memory, "species");
      if (next.size() != 1 || ids.size() != numbers.size())
        evodevo::SelectionMemory::fail("has the species of " + std::to_string(numbers.size()) + " individuals and " +
                                       std::to_string(next.size()) + " next ones; expected " +
                                       std::to_string(ids.size()) + " and 1");
      known.next = next.front();
      for (std::size_t i = 0; i < ids.size(); ++i) known.species[ids[i]] = numbers[i];
      return known;
    }
    evodevo::SelectionMemory memory() const {
      Numbers ids, numbers;
      for (const auto& [id, number] : species) ids.push_back(id), numbers.push_back(number);
      return {.lists = {{"ids", evodevo::memory_list(ids)},
                        {"species", evodevo::memory_list(numbers)},
                        {"next", {static_cast<double>(next)}}}};
    }
    /// Returns the species of an individual, or 0, which is none, if it is not known.
    std::uint32_t species_of(const Candidate& row) const {
      const auto found = species.find(row.id);
      return found == species.end() ? 0 : found->second;
    }

    std::map<std::uint32_t, std::uint32_t> species = {};
    std::uint32_t next = 1;
  };

  /// Returns the first score of each row of `order`, which is from best to worst, relative to the best:
  /// counted from 0, or from the lowest one if that is below 0; 1 if all are equal. Rows that failed are equal.
  static std::vector<double> shares(std::span<const Candidate> rows, const Numbers& order) {
    const auto half = [&](std::uint32_t row) { return rows[row].ok() ? rows[row].scores[0] / 2 : 0; };  // no overflow
    std::vector<double> shares;
    for (const std::uint32_t row : order) {
      const double low = std::min(0.0, half(order.back())), range = half(order.front()) - low;
      shares.push_back(range > 0 ? (half(row) - low) / range : 1);
    }
    return shares;
  }

  /// Returns the positions of at most `count` individuals, chosen one by one by their worth, which is shared with the
  /// members of the same species that were chosen before. Positions are from best to worst, so the next one of each
  /// species is its first one that is left.
  static Numbers chosen(const std::vector<double>& worth, const Numbers& species, std::uint32_t count) {
    std::map<std::uint32_t, std::queue<std::uint32_t>> left;  // positions
    std::map<std::uint32_t, double> members;
    for (std::uint32_t i = 0; i < species.size(); ++i) left[species[i]].push(i);
    const auto share = [&](std::uint32_t i) { return worth[i] / (1 + members[species[i]]); };
    std::set<std::pair<double, std::uint32_t>> next;  // with the negative share, so that the best comes first
    for (const auto& [number, positions] : left) next.emplace(-share(positions.front()), positions.front());
    Numbers chosen;
    while (chosen.size() < count && !next.empty()) {
      chosen.push_back(next.extract(next.begin()).value().second);
      const std::uint32_t number = species[chosen.back()];
      ++members[number];
      left[number].pop();
      if (!left[number].empty()) next.emplace(-share(left[number].front()), left[number].front());
    }
    return chosen;
  }

  double difference(const SelectionContext& context, std::uint32_t one, std::uint32_t other) const {
    const auto distance =
        evodevo::genome_distance(*context.rows[one].genome, *context.rows[other].genome, context.layout);
    return distance.blocks + weight_ * distance.genes;
  }

  /// Returns the species whose representative is most similar to a row, or 0 if none is similar enough.
  std::uint32_t nearest(const SelectionContext& context, const std::map<std::uint32_t, std::uint32_t>& representatives,
                        std::uint32_t row) const {
    std::uint32_t nearest = 0;
    double least = threshold_;
    for (const auto& [number, representative] : representatives)
      if (const double distance = difference(context, row, representative);
          distance < least || (distance == least && nearest == 0))
        nearest = number, least = distance;
    return nearest;
  }

  /// Returns the species of each row of `order`, which is from best to worst, and numbers the new ones.
  Numbers classified(const SelectionContext& context, const Numbers& order, Known& known) const {
    std::map<std::uint32_t, std::uint32_t> representatives;  // row by species
    std::set<std::uint32_t> seen{0};
    for (const std::uint32_t row : order) {
      const std::uint32_t number = known.species_of(context.rows[row]);
      const bool is_best = seen.insert(number).second;
      if (is_best && nearest(context, representatives, row) == 0) representatives.emplace(number, row);
    }
    Numbers species;
    for (const std::uint32_t row : order) {
      std::uint32_t number = nearest(context, representatives, row);
      if (number == 0) representatives.emplace(number = known.next++, row);
      species.push_back(number);
    }
    return species;
  }

  double threshold_ = 0.2;
  double weight_ = 1;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<SpeciesSelection>("species",
                                                         "Individuals with similar genomes form species and share "
                                                         "their fitness (NEAT: Stanley & Miikkulainen 2002)."))
