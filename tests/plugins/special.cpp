// Operators that need more than generated inputs: an encoding with blocks of its own, a mutation that works on such
// blocks, one that works on blocks that no encoding of the library has, one that requires a file, a devo operator that
// asks for all records of masses and remembers numbers, a fitness that is measured within the life, and selections that
// choose either parents or survivors alone, or need three objectives.
#include <algorithm>

#include "evodevo/helpers/rows.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Genome;
using evodevo::Layout;
using evodevo::Rng;
using evodevo::VariationContext;

/// A tree: each twig begins where the twig ends to which it refers.
struct Twigs final : evodevo::Encoding {
  Layout layout(const evodevo::EncodingContext&) const override {
    Layout layout;
    const evodevo::GeneSpec direction{-1, 1}, parent{.refers_to = 0};
    layout.add_type({"twig", {direction, direction, direction, parent}, 1, 6, {"x", "y", "z", "parent"}});
    for (int i = 0; i < 4; ++i) layout.add_block_of(0);
    return layout;
  }
  evodevo::Blueprint decode(const Genome& genome, const evodevo::Layout&,
                            const evodevo::EncodingContext& context) const override {
    evodevo::Blueprint blueprint;
    evodevo::Body& body = blueprint.body;
    body.materials = context.materials;
    body.masses.push_back({{0, 0, 0}, context.mass});
    for (const evodevo::Block& twig : genome.blocks) {
      const auto from = static_cast<std::uint32_t>(genome[twig.first + 3]) % body.masses.size();
      const evodevo::Vec3 way{genome[twig.first], genome[twig.first + 1], 2.0 + genome[twig.first + 2]};
      body.springs.push_back(
          {static_cast<std::uint32_t>(from), static_cast<std::uint32_t>(body.masses.size()), norm(way), 0});
      body.masses.push_back({body.masses[from].rest + way, context.mass});
    }
    return blueprint;
  }
};

/// Draws a gene of a block of one type anew.
struct Redraw : evodevo::Mutation {
  explicit Redraw(const char* type) : type_(type) {}
  evodevo::Traits traits() const override { return {.block_types = {type_}}; }
  void mutate(Genome& genome, const VariationContext& context, Rng& rng) const override {
    const Layout& layout = context.layout;
    for (const evodevo::Block& block : layout.blocks(genome))
      if (layout.types[block.type].name == type_) genome[block.first] = layout.draw(genome, block.first, rng);
  }

 private:
  const char* type_;
};
struct BendTwig final : Redraw {
  BendTwig() : Redraw("twig") {}
};
struct BendLeaf final : Redraw {
  BendLeaf() : Redraw("leaf") {}
};

/// Replaces the mass that has felt least of the ground and of its springs, and remembers what each has felt.
struct Feeling final : evodevo::Devo {
  evodevo::RecordRequest observes() const override {
    return {.contact = true, .age = true, .degree = true, .load = true};
  }
  evodevo::Measure measure(evodevo::EditKind) const override { return {"feeling", "1"}; }
  std::vector<std::string> mass_memory() const override { return {"feeling"}; }
  std::vector<std::string> spring_memory() const override { return {"came"}; }
  void develop(const evodevo::DevoContext& context, evodevo::Edits& edits, Rng&) const override {
    const auto masses = static_cast<std::uint32_t>(context.body.masses.size());
    std::vector<double> felt;
    for (std::uint32_t i = 0; i < masses; ++i) {
      felt.push_back(context.mass_memory[i][0] + context.contact[i] +
                     context.load[i] / (1 + context.degree[i]) / (1 + context.age[i]));
      edits.remember_mass(i, {felt[i]});
    }
    if (masses < 4) return;
    const auto least = static_cast<std::uint32_t>(std::min_element(felt.begin(), felt.end()) - felt.begin());
    edits.remove_mass(least, {.cause = felt[least]});
    const std::uint32_t newest = edits.add_mass(context.bounds.low + 0.5 * (context.bounds.high - context.bounds.low));
    for (std::uint32_t i = 0, joined = 0; i < masses && joined < 3; ++i) {
      if (i == least) continue;
      edits.remember_spring(edits.join(i, newest, {1000, 0, 0, 0}), {static_cast<double>(context.cycle)});
      ++joined;
    }
  }
};

/// Gives the first real gene the value of a random character of a file.
struct ByFile final : evodevo::Mutation {
  void parameters(evodevo::Parameters& p) override {
    p.file(file_, "file", "A text of digits.");
    p.require(!file_.path.empty(), "file", "expected a file of digits");
  }
  void mutate(Genome& genome, const VariationContext& context, Rng& rng) const override {
    const auto size = static_cast<std::uint32_t>(file_.content.size());
    const int digit = file_.content.at(rng.below(size)) - '0';
    for (std::size_t i = 0; i < genome.size(); ++i) {
      const evodevo::GeneSpec& gene = context.layout.gene(genome, i);
      if (!gene.is_real()) continue;
      genome[i] = gene.low + (gene.high - gene.low) * static_cast<float>(digit) / 9;
      return;
    }
  }

 private:
  evodevo::InputFile file_;
};

/// Measures how far a body moves along x at the beginning of its life.
struct EarlyWay final : evodevo::Fitness {
  evodevo::Request observes() const override { return {.window = 0.05, .cycle = 0}; }
  std::vector<evodevo::Objective> objectives() const override { return {{"early-way", "m", true}}; }
  std::vector<double> score(const evodevo::Observation& seen) const override {
    return {seen.centre_after.x - seen.centre_before.x};
  }
};

/// Chooses parents alone, all with the same chance.
struct Lottery : evodevo::Selection {
  std::vector<evodevo::Couple> parents(const evodevo::SelectionContext& context, std::uint32_t count,
                                       Rng& rng) const override {
    return draw_pairs(context.rows, count, rng, evodevo::draw_any);
  }
};

/// Chooses survivors alone: the best.
struct Best final : evodevo::Selection {
  void parameters(evodevo::Parameters& p) override {
    p.integer(seed_, "seed", {0, 1e18, "1"}, "A number that has no effect, of a wide range.");
  }
  evodevo::Survival survivors(const evodevo::SelectionContext& context, std::uint32_t population, Rng&) const override {
    return evodevo::first_rows(best_first(context.rows), population);
  }

 private:
  std::int64_t seed_ = 0;
};

/// Chooses parents alone, and needs three objectives.
struct ThreeGoals final : Lottery {
  evodevo::Traits traits() const override { return {.least_objectives = 3}; }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Twigs>("twigs", "Grows a tree of springs."),
               evodevo::operator_entry<BendTwig>("bend-twig", "Gives each twig another direction."),
               evodevo::operator_entry<BendLeaf>("bend-leaf", "Gives each leaf another direction."),
               evodevo::operator_entry<Feeling>("feeling", "Replaces the mass that has felt least."),
               evodevo::operator_entry<ByFile>("by-file", "Sets a gene to what a file says."),
               evodevo::operator_entry<EarlyWay>("early-way", "Measures the way along x while the body develops."),
               evodevo::operator_entry<Lottery>("lottery", "All have the same chance to breed."),
               evodevo::operator_entry<Best>("best", "The best survive."),
               evodevo::operator_entry<ThreeGoals>("three-goals", "Needs three objectives."))
