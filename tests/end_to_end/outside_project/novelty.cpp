// A selection operator that remembers: novelty search with an archive (Lehman & Stanley 2011).
#include <algorithm>
#include <cmath>
#include <limits>

#include "evodevo/helpers/rows.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Candidate;
using evodevo::SelectionContext;

/// The individuals whose descriptors differ most from those of their nearest neighbour survive. In every generation,
/// the archive gets the descriptors of the most novel of those who do not.
class Novelty final : public evodevo::Selection {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.integer(archived_, "archived", {0, 1000, "1"},
              "Number of individuals that enter the archive in each generation.");
  }

  evodevo::Traits traits() const override { return {.is_elitist = false, .least_descriptors = 1}; }
  std::vector<evodevo::NoteTitle> notes() const override { return {{"novelty"}}; }
  std::vector<std::string> memory() const override { return {"archive"}; }

  std::vector<evodevo::Couple> parents(const SelectionContext& context, std::uint32_t count,
                                       evodevo::Rng& rng) const override {
    return draw_pairs(context.rows, count, rng, evodevo::draw_any);
  }

  evodevo::Survival survivors(const SelectionContext& context, std::uint32_t population, evodevo::Rng&) const override {
    std::vector<double> archive;  // the descriptors of all who are in it
    if (!context.memory.empty()) archive = context.memory.list("archive");
    auto order = best_first(context.rows);
    evodevo::Survival survival;
    std::vector<double> novelty(order.size(), -1);  // failed rows come last
    for (const std::uint32_t row : order) {
      if (!context.rows[row].ok()) continue;
      novelty[row] = novelty_of(row, context, archive);
      survival.notes.push_back({row, 0, novelty[row]});
    }
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return novelty[a] > novelty[b]; });
    const std::size_t survivors = std::min<std::size_t>(order.size(), population);
    survival.rows.assign(order.begin(), order.begin() + survivors);
    std::int64_t left = archived_;
    for (std::size_t i = survivors; i < order.size(); ++i)
      if (const Candidate& one = context.rows[order[i]]; one.ok() && left-- > 0)
        archive.insert(archive.end(), one.descriptors.begin(), one.descriptors.end());
    survival.memory = evodevo::SelectionMemory{.lists = {{"archive", archive}}};
    return survival;
  }

 private:
  /// Returns the distance of a row to its nearest neighbour in the table and in the archive. Each descriptor counts
  /// relative to its range.
  static double novelty_of(std::uint32_t row, const SelectionContext& context, const std::vector<double>& archive) {
    const auto own = context.rows[row].descriptors;
    double least = std::numeric_limits<double>::max();
    const auto compare = [&](std::span<const double> other) {
      double sum = 0;
      for (std::size_t d = 0; d < own.size(); ++d)
        sum += std::pow((own[d] - other[d]) / (context.descriptors[d].high - context.descriptors[d].low), 2);
      least = std::min(least, std::sqrt(sum));
    };
    for (std::uint32_t other = 0; other < context.rows.size(); ++other)
      if (other != row && context.rows[other].ok()) compare(context.rows[other].descriptors);
    for (std::size_t i = 0; i < archive.size(); i += own.size()) compare(std::span(archive).subspan(i, own.size()));
    return least;
  }

  std::int64_t archived_ = 2;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Novelty>("outside.novelty",
                                                "The individuals whose behaviour differs most from others survive "
                                                "(Lehman & Stanley 2011)."))
