@selection@
#include "evodevo/helpers/rows.hpp"
@end@
#include "evodevo/plugin.hpp"

namespace {

@encoding@
/// Each mass has a block of four genes: three for its position and one for its material. The host joins neighbouring masses.
class @CLASS@ final : public evodevo::Encoding {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.integer(masses_, "masses", {4, 1000, "1"}, "Number of masses of a body.");
    p.real(side_, "side", {0.01, 100, "m"}, "Side length of the cube in which the masses lie.");
  }

  evodevo::Layout layout(const evodevo::EncodingContext& context) const override {
    const evodevo::GeneSpec place{-1, 1}, material{0, 0, static_cast<std::uint32_t>(context.materials.size())};
    evodevo::Layout layout;
    for (std::int64_t i = 0; i < masses_; ++i) layout.add_block({place, place, place, material}, "mass");
    layout.types.front().gene_names = {"x", "y", "z", "material"};
    layout.types.front().name_options(3, context.material_names);
    return layout;
  }

  evodevo::Blueprint decode(const evodevo::Genome& genome, const evodevo::Layout&,
                            const evodevo::EncodingContext& context) const override {
    evodevo::Blueprint blueprint;
    blueprint.body.materials = context.materials;
    blueprint.neighbours = 8;
    for (std::size_t i = 0; i + 3 < genome.size(); i += 4) {
      const evodevo::Vec3 position = (side_ / 2) * evodevo::Vec3{genome[i], genome[i + 1], genome[i + 2]};
      blueprint.body.masses.push_back({position, context.mass, static_cast<std::int32_t>(genome[i + 3])});
    }
    return blueprint;
  }

 private:
  std::int64_t masses_ = 24;
  double side_ = 1;
};
@mutation@
/// Draws each gene anew with probability `rate`. Several genes may change, or none.
class @CLASS@ final : public evodevo::Mutation {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.real(rate_, "rate", {0, 1, "1"}, "Probability that a gene gets a new random value.");
  }

  void mutate(evodevo::Genome& genome, const evodevo::VariationContext& context, evodevo::Rng& rng) const override {
    for (std::size_t i = 0; i < genome.size(); ++i)
      if (rng.chance(rate_)) genome[i] = context.layout.draw(genome, i, rng);
  }

 private:
  double rate_ = 0.1;
};
@crossover@
/// Uniform crossover: the child is the first parent, with each block taken from the second with probability `rate`.
class @CLASS@ final : public evodevo::Crossover {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.real(rate_, "rate", {0, 1, "1"}, "Probability that a block comes from the second parent.");
  }

  evodevo::Genome cross(const evodevo::Parents& parents, const evodevo::VariationContext& context,
                        evodevo::Rng& rng) const override {
    evodevo::Genome child = parents.first;
    const auto partners = homologous(child, parents.second, context.layout);
    for (std::uint32_t block = 0; block < partners.size(); ++block)
      if (partners[block] && rng.chance(rate_)) copy_genes(child, block, parents.second, *partners[block], context.layout);
    return child;
  }

 private:
  double rate_ = 0.5;
};
@devo@
/// Removes `springs` random springs after each cycle, or fewer if the same spring is drawn twice. evodevo::Edits in
/// evodevo/devo.hpp lists all changes that a devo operator can make.
class @CLASS@ final : public evodevo::Devo {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.integer(springs_, "springs", {0, 1000, "1"}, "Number of random springs that are removed in each cycle.");
  }

  void develop(const evodevo::DevoContext& context, evodevo::Edits& edits, evodevo::Rng& rng) const override {
    const auto count = static_cast<std::uint32_t>(context.body.springs.size());
    for (std::int64_t i = 0; i < springs_ && count > 0; ++i) edits.remove_spring(rng.below(count));
  }

 private:
  std::int64_t springs_ = 5;
};
@fitness@
/// Measures the horizontal speed in m/s. Unlike a speed in body lengths per second, this favours large bodies.
class @CLASS@ final : public evodevo::Fitness {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.real(settle_, "settle", {0, 3600, "s"}, "Time in which the body settles before it is measured.");
    p.real(window_, "window", {0.001, 3600, "s"}, "Time in which the body is measured.");
  }

  evodevo::Request observes() const override { return {settle_, window_, false}; }

  std::vector<evodevo::Objective> objectives() const override { return {{"@NAME@", "m/s", true}}; }

  std::vector<double> score(const evodevo::Observation& observation) const override {
    evodevo::Vec3 way = observation.centre_after - observation.centre_before;
    way.z = 0;
    return {norm(way) / observation.window};
  }

 private:
  double settle_ = 1;
  double window_ = 2;
};
@selection@
using evodevo::SelectionContext;

/// Truncation selection: only the best part of the population breeds. Failed rows have no scores and come last.
class @CLASS@ final : public evodevo::Selection {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.real(breeders_, "breeders", {0, 1, "1"}, "Fraction of the population that breeds, the best first.");
  }

  std::vector<evodevo::Couple> parents(const SelectionContext& context, std::uint32_t count,
                                       evodevo::Rng& rng) const override {
    return draw_pairs(context.rows, count, rng, [&](std::uint32_t size, evodevo::Rng& random) {
      return random.below(std::max(1u, static_cast<std::uint32_t>(breeders_ * size)));
    });
  }

  evodevo::Survival survivors(const SelectionContext& context, std::uint32_t population, evodevo::Rng&) const override {
    return evodevo::first_rows(best_first(context.rows), population);
  }

 private:
  double breeders_ = 0.5;
};
@end@

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
@encoding@
               evodevo::operator_entry<@CLASS@>("@NAME@", "Every mass has a place and a material of its own."))
@mutation@
               evodevo::operator_entry<@CLASS@>("@NAME@",
                                                "Gives every gene a new random value with a small probability."))
@crossover@
               evodevo::operator_entry<@CLASS@>("@NAME@", "Takes each block from the second parent with a given probability."))
@devo@
               evodevo::operator_entry<@CLASS@>("@NAME@", "Removes a few random springs."))
@fitness@
               evodevo::operator_entry<@CLASS@>("@NAME@",
                                                "Speed of the centre of mass in any direction along the ground."))
@selection@
               evodevo::operator_entry<@CLASS@>("@NAME@",
                                                "The best by the first objective survive, and the best fraction of "
                                                "them breeds."))
@end@
