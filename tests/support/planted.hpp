// Experiments in which it is known what of a score is due to the genes.
#pragma once

#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "support/experiments.hpp"
#include "support/scorer.hpp"

namespace evodevo::testing {

/// An encoding whose body says how good its genome is: the mean of the genes, 0 to 1, is the phase of a spring that
/// does not move.
struct Planted final : Encoding {
  std::unique_ptr<Encoding> encoding;

  explicit Planted(std::unique_ptr<Encoding> one) : encoding(std::move(one)) {}
  Layout layout(const EncodingContext& context) const override { return encoding->layout(context); }
  static double quality(const Genome& genome) {
    return std::accumulate(genome.genes.begin(), genome.genes.end(), 0.0) /
           (4 * static_cast<double>(genome.genes.size()));
  }
  Blueprint decode(const Genome& genome, const Layout&, const EncodingContext& context) const override {
    Blueprint blueprint;
    blueprint.body.materials = context.materials;
    const std::uint32_t own = blueprint.body.material_index({1, 0, 0, quality(genome)});
    blueprint.body.masses = {{{0, 0, 0}, 1}, {{1, 0, 0}, 1}};
    blueprint.body.springs = {{0, 1, 1, own}};
    return blueprint;
  }
};

/// Selection sees the quality of a genome, and noise by birth that is larger than most differences between genomes.
inline Experiment planted(const std::vector<std::string>& values, double noise = 0.5) {
  std::vector<std::string> all{"experiment.birth_noise=0.1",    "development.draws=individual",
                               "development.control=no-change", "scene.gravity.acceleration=0",
                               "encoding.size=[6, 3, 1]",       "selection.name=elitist",
                               "experiment.population=20"};
  all.insert(all.end(), values.begin(), values.end());
  Experiment experiment = small(all);
  experiment.encoding = std::make_unique<Planted>(std::move(experiment.encoding));
  experiment.cases = {{0}};
  score_by(experiment, {{{.settle = 0, .window = 0.02}, {{"quality", "1"}}, [noise](const Observation& seen) {
                           const Body& body = *seen.body;
                           const double luck = (seen.box.high.x - seen.box.low.x - 1) / 0.1;
                           return std::vector{body.materials[body.springs[0].material].phase + noise * luck};
                         }}});
  return experiment;
}

}  // namespace evodevo::testing
