// A selection operator that remembers: novelty search with an archive (Lehman & Stanley 2011).
#include <algorithm>
#include <cmath>

#include "evodevo/helpers/rows.hpp"
#include "evodevo/helpers/selection/memory.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Candidate;

/// The individuals whose descriptors differ most from those of their nearest neighbours survive. In every generation,
/// the archive gets the descriptors of the most novel newborns.
class Novelty final : public evodevo::Selection {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.integer(neighbours_, "neighbours", {1, 1000, "1"}, "Number of nearest neighbours.");
    p.integer(archived_, "archived", {0, 1000, "1"}, "Number of newborns that enter the archive in each generation.");
  }

  evodevo::Traits traits() const override { return {.is_elitist = false, .least_descriptors = 1}; }
  std::vector<evodevo::NoteTitle> notes() const override { return {{"novelty"}}; }

  std::vector<std::pair<std::uint32_t, std::uint32_t>> parents(std::span<const Candidate> rows, std::uint32_t count,
                                                               evodevo::Rng& rng) const override {
    return draw_pairs(rows, count, rng, evodevo::draw_any);
  }

  evodevo::Survival survive(const evodevo::SelectionContext& context, std::uint32_t population,
                            evodevo::Rng&) const override {
    Archive archive(context.memory);
    const std::vector<double> others = archive.of_others(context);
    auto order = best_first(context.rows);
    evodevo::Survival survival;
    std::vector<double> novelty(order.size(), -1);  // failed rows come last
    for (const std::uint32_t row : order) {
      if (!context.rows[row].ok()) continue;
      novelty[row] = novelty_of(row, context, others);
      survival.notes.push_back({row, 0, novelty[row]});
    }
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return novelty[a] > novelty[b]; });
    survival.rows.assign(order.begin(), order.begin() + std::min<std::size_t>(order.size(), population));

    std::int64_t left = archived_;
    for (const std::uint32_t row : order) {
      const Candidate& one = context.rows[row];
      if (one.ok() && one.is_newborn && left-- > 0) archive.add(one);
    }
    survival.memory = archive.written();
    return survival;
  }

 private:
  /// The memory: ids of individuals, and the descriptors of all of them.
  struct Archive {
    explicit Archive(std::span<const std::byte> memory) {
      if (memory.empty()) return;
      evodevo::MemoryReader reader(memory);
      ids = reader.read_list<std::uint32_t>();
      values = reader.read_list<double>();
      reader.finish();
    }
    /// Returns the descriptors of those who are not in the table.
    std::vector<double> of_others(const evodevo::SelectionContext& context) const {
      const std::size_t size = context.descriptors.size();
      std::vector<double> others;
      for (std::size_t i = 0; i < ids.size(); ++i)
        if (std::none_of(context.rows.begin(), context.rows.end(), [&](auto& row) { return row.id == ids[i]; }))
          others.insert(others.end(), &values.at(i * size), &values.at(i * size) + size);
      return others;
    }
    void add(const Candidate& one) {
      ids.push_back(one.id);
      values.insert(values.end(), one.descriptors.begin(), one.descriptors.end());
    }
    std::vector<std::byte> written() const {
      evodevo::MemoryWriter writer;
      writer.write(ids);
      writer.write(values);
      return writer.bytes();
    }
    std::vector<std::uint32_t> ids;
    std::vector<double> values;
  };

  /// Returns the mean distance of a row to its nearest neighbours in the table and among others, given by their
  /// descriptors. Each descriptor counts relative to its range.
  double novelty_of(std::uint32_t row, const evodevo::SelectionContext& context,
                    const std::vector<double>& others) const {
    const auto own = context.rows[row].descriptors;
    const auto distance = [&](std::span<const double> other) {
      double sum = 0;
      for (std::size_t d = 0; d < own.size(); ++d)
        sum += std::pow((own[d] - other[d]) / (context.descriptors[d].high - context.descriptors[d].low), 2);
      return std::sqrt(sum);
    };
    std::vector<double> distances;
    for (std::uint32_t other = 0; other < context.rows.size(); ++other)
      if (other != row && context.rows[other].ok()) distances.push_back(distance(context.rows[other].descriptors));
    for (std::size_t i = 0; i < others.size(); i += own.size())
      distances.push_back(distance(std::span(others).subspan(i, own.size())));
    std::sort(distances.begin(), distances.end());
    distances.resize(std::min<std::size_t>(distances.size(), neighbours_));
    double sum = 0;
    for (const double one : distances) sum += one;
    return distances.empty() ? 0 : sum / static_cast<double>(distances.size());
  }

  std::int64_t neighbours_ = 5, archived_ = 2;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Novelty>("outside.novelty",
                                                "The individuals whose behaviour differs most from others survive "
                                                "(Lehman & Stanley 2011)."))
