// CMA-ES: children are drawn from a normal distribution that learns from them (Hansen and Ostermeier 2001).
#include "evodevo/helpers/selection/cma_es.hpp"

#include "evodevo/helpers/rows.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Candidate;
using evodevo::SelectionContext;

/// The range of each gene becomes [0, 1]; genes that can have only one value are left out. The distribution learns from
/// the first scores of the newborns; those who failed are the worst, and among them those are better that violate the
/// constraints less. The best individuals so far survive, but they do not breed: the memory holds the distribution.
class Cma final : public evodevo::Selection {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.real(step_, "step", {1e-6, 0.33, "1"},
           "Standard deviation of the genes in the first generation, relative to their ranges.");
  }

  evodevo::Traits traits() const override { return {.needs_real_genes = true, .least_children = 2}; }
  std::vector<std::string> memory() const override { return {"distribution"}; }

  evodevo::Offspring children(const SelectionContext& context, std::uint32_t count, evodevo::Rng& rng) const override {
    const auto genes = specs(context.layout);
    std::vector<evodevo::Child> children;
    for (const auto& point : distribution(context).sample(count, rng)) {
      evodevo::Genome genome(genes.size());
      auto coordinate = point.begin();
      for (std::size_t i = 0; i < genes.size(); ++i) {
        const double value = is_free(genes[i]) ? genes[i].low + *coordinate++ * range(genes[i]) : genes[i].low;
        genome[i] = std::clamp(static_cast<float>(value), genes[i].low, genes[i].high);
      }
      children.push_back({std::move(genome)});
    }
    return children;
  }

  evodevo::Survival survivors(const SelectionContext& context, std::uint32_t population,
                              evodevo::Rng& rng) const override {
    evodevo::Survival survival{best_first(context.rows)};
    const auto genes = specs(context.layout);
    std::vector<std::vector<double>> points;
    std::vector<std::uint32_t> ranks;
    const Candidate* last = nullptr;
    for (const std::uint32_t i : survival.rows) {
      const Candidate& row = context.rows[i];
      if (!row.is_newborn) continue;
      const bool is_tied = last != nullptr && !evodevo::is_better(*last, row);
      ranks.push_back(is_tied ? ranks.back() : static_cast<std::uint32_t>(ranks.size()));
      last = &row;
      std::vector<double>& point = points.emplace_back();
      for (std::size_t g = 0; g < genes.size(); ++g)
        if (is_free(genes[g])) point.push_back((double{(*row.genome)[g]} - genes[g].low) / range(genes[g]));
    }
    auto learned = distribution(context);
    learned.update(points, ranks, rng);
    survival.memory = evodevo::SelectionMemory{.lists = {{"distribution", learned.state()}}};
    survival.rows = evodevo::first_rows(std::move(survival.rows), population);
    return survival;
  }

 private:
  static constexpr std::size_t most_genes = 1000;  // with more, each generation would take seconds

  static bool is_free(const evodevo::GeneSpec& gene) { return gene.high > gene.low; }
  static double range(const evodevo::GeneSpec& gene) { return double{gene.high} - gene.low; }

  static std::vector<evodevo::GeneSpec> specs(const evodevo::Layout& layout) {
    std::vector<evodevo::GeneSpec> genes;
    for (const evodevo::Block& block : layout.first_blocks)
      for (std::uint32_t gene = 0; gene < block.count; ++gene) genes.push_back(layout.types[block.type].gene(gene));
    return genes;
  }

  evodevo::CmaEs distribution(const SelectionContext& context) const {
    const auto all = specs(context.layout);
    const auto genes = static_cast<std::size_t>(std::count_if(all.begin(), all.end(), is_free));
    if (genes < 1 || genes > most_genes)
      throw std::runtime_error("genomes have " + std::to_string(genes) + " genes with a range; expected 1 to " +
                               std::to_string(most_genes) + "; choose another encoding, or the selection " +
                               "\"differential\"");
    if (context.memory.empty()) return {genes, step_};
    return {genes, context.memory.list("distribution")};
  }

  double step_ = 0.3;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Cma>("cma-es",
                                            "Children are drawn from a normal distribution that learns from them "
                                            "(CMA-ES: Hansen & Ostermeier 2001)."))
