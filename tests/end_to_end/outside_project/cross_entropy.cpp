// A selection operator that makes the children itself: the cross-entropy method with a normal distribution for each
// gene (Rubinstein 1999).
#include <algorithm>
#include <cmath>

#include "evodevo/helpers/rows.hpp"
#include "evodevo/plugin.hpp"

namespace {

/// Samples the children from a distribution, which moves towards the best individuals of each generation.
class CrossEntropy final : public evodevo::Selection {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.real(share_, "share", {0.01, 1, "1"}, "Share of the newborns towards which the distribution moves.");
    p.real(rate_, "rate", {0.01, 1, "1"}, "Part of the way that it moves.");
  }

  evodevo::Traits traits() const override { return {.needs_real_genes = true}; }
  std::vector<evodevo::NoteTitle> notes() const override { return {{"distance from the mean"}}; }
  std::vector<std::string> memory() const override { return {"mean", "deviation"}; }

  evodevo::Offspring children(const evodevo::SelectionContext& context, std::uint32_t count,
                              evodevo::Rng& rng) const override {
    const evodevo::Genome sizes(context.layout.first_size());
    const Distribution now = distribution_in(context);
    std::vector<evodevo::Child> children(count);
    for (evodevo::Child& child : children) {
      child.genome = sizes;
      for (std::size_t gene = 0; gene < sizes.size(); ++gene) {
        const evodevo::GeneSpec& spec = context.layout.gene(sizes, gene);
        const double value = now.mean[gene] + now.deviation[gene] * rng.normal();
        child.genome[gene] = std::clamp(static_cast<float>(value), spec.low, spec.high);
      }
    }
    return children;
  }

  evodevo::Survival survivors(const evodevo::SelectionContext& context, std::uint32_t population,
                              evodevo::Rng&) const override {
    const auto order = best_first(context.rows);
    Distribution now = distribution_in(context);
    evodevo::Survival survival;
    for (const std::uint32_t row : order)
      if (context.rows[row].ok()) survival.notes.push_back({row, 0, distance(*context.rows[row].genome, now.mean)});
    move(now, elite_of(context.rows, order));
    survival.rows = evodevo::first_rows(order, population);
    survival.memory = evodevo::SelectionMemory{.lists = {{"mean", now.mean}, {"deviation", now.deviation}}};
    return survival;
  }

 private:
  /// The means and standard deviations of all genes.
  struct Distribution {
    std::vector<double> mean, deviation;
  };

  /// At first, the distribution covers the whole range of every gene.
  static Distribution distribution_in(const evodevo::SelectionContext& context) {
    Distribution now;
    if (context.memory.empty()) {
      const evodevo::Genome sizes(context.layout.first_size());
      for (std::size_t gene = 0; gene < sizes.size(); ++gene) {
        const evodevo::GeneSpec& spec = context.layout.gene(sizes, gene);
        now.mean.push_back((spec.low + spec.high) / 2);
        now.deviation.push_back((spec.high - spec.low) / 2);
      }
      return now;
    }
    return {context.memory.list("mean"), context.memory.list("deviation")};
  }

  /// Returns the genomes of the best newborns.
  std::vector<const evodevo::Genome*> elite_of(std::span<const evodevo::Candidate> rows,
                                               const std::vector<std::uint32_t>& order) const {
    std::vector<const evodevo::Genome*> elite;
    for (const std::uint32_t row : order)
      if (rows[row].ok() && rows[row].is_newborn) elite.push_back(rows[row].genome);
    elite.resize(static_cast<std::size_t>(std::ceil(share_ * static_cast<double>(elite.size()))));
    return elite;
  }

  void move(Distribution& now, const std::vector<const evodevo::Genome*>& elite) const {
    if (elite.empty()) return;
    const auto count = static_cast<double>(elite.size());
    for (std::size_t gene = 0; gene < now.mean.size(); ++gene) {
      double sum = 0, squares = 0;
      for (const evodevo::Genome* genome : elite) sum += (*genome)[gene];
      for (const evodevo::Genome* genome : elite) squares += std::pow((*genome)[gene] - sum / count, 2);
      now.mean[gene] += rate_ * (sum / count - now.mean[gene]);
      now.deviation[gene] += rate_ * (std::sqrt(squares / count) - now.deviation[gene]);
    }
  }

  static double distance(const evodevo::Genome& genome, const std::vector<double>& mean) {
    double sum = 0;
    for (std::size_t gene = 0; gene < mean.size(); ++gene) sum += std::pow(genome[gene] - mean[gene], 2);
    return std::sqrt(sum);
  }

  double share_ = 0.25, rate_ = 0.7;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<CrossEntropy>("outside.cross-entropy",
                                                     "Samples children near the best individuals so far (Rubinstein "
                                                     "1999)."))
