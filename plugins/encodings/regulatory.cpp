// Bodies that grow from one cell by regulatory genes: cells divide, differentiate and adhere.
#include <array>
#include <cmath>
#include <map>
#include <string>

#include "evodevo/helpers/materials.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Genome;
using evodevo::Vec3;

/// A site of the face-centred cubic lattice: whole numbers with an even sum.
using Site = std::array<int, 3>;

constexpr std::array<Site, 12> ways = {{{1, 1, 0},
                                        {-1, -1, 0},
                                        {1, -1, 0},
                                        {-1, 1, 0},
                                        {1, 0, 1},
                                        {-1, 0, -1},
                                        {1, 0, -1},
                                        {-1, 0, 1},
                                        {0, 1, 1},
                                        {0, -1, -1},
                                        {0, 1, -1},
                                        {0, -1, 1}}};

Site beside(const Site& site, const Site& way) { return {site[0] + way[0], site[1] + way[1], site[2] + way[2]}; }

/// What genes make in a cell. After these come the products that the cell remembers when it has become a mass, the
/// first of which is its signal, and then one for each material.
enum Product : std::size_t { divide, to_x, to_y, to_z, adhesion, products };
/// What regulates genes, after the products of the cell itself.
enum Surroundings : std::size_t { neighbours, room, time_gone, x, y, z, surroundings };

/// The positions of the numbers of a gene.
struct Gene {
  enum At : std::size_t { product, input_a, weight_a, input_b, weight_b, bias, size };
};

/// An embryo whose cells all run the same genes, each at its own concentrations.
class Embryo {
 public:
  /// `count` is the number of products.
  Embryo(const Genome& genome, std::size_t count) : genome_(genome), products_(count), genes_of_(count) {
    for (const float* gene = genome.data(); gene != genome.data() + genome.size(); gene += Gene::size)
      ++genes_of_[static_cast<std::size_t>(gene[Gene::product])];
    add({0, 0, 0}, std::vector<double>(products_), 0);
  }

  /// Lets `steps` steps pass. In each, first all concentrations change at the same time, then cells divide. In the end,
  /// concentrations change once more, so that the youngest cells feel where they are.
  void grow(std::int64_t steps, std::size_t most_cells) {
    for (std::int64_t step = 0; step < steps; ++step) {
      regulate(static_cast<double>(step) / static_cast<double>(steps));
      divide_cells(most_cells);
    }
    regulate(1);
  }

  std::size_t size() const { return sites_.size(); }
  const Site& site(std::size_t cell) const { return sites_[cell]; }
  double concentration(std::size_t cell, std::size_t product) const { return concentrations_[cell][product]; }
  /// The identities of all cells: that of a daughter follows from her mother's and from how many daughters her mother
  /// had before.
  const std::vector<std::uint64_t>& identities() const { return identities_; }

  /// Calls function(cell) for each cell beside a cell, in a fixed order.
  template <class Function>
  void for_each_beside(std::size_t cell, const Function& function) const {
    for (const Site& way : ways)
      if (const auto found = cell_at_.find(beside(sites_[cell], way)); found != cell_at_.end()) function(found->second);
  }

 private:
  void add(const Site& site, std::vector<double> concentrations, std::uint64_t identity) {
    identities_.push_back(identity);
    daughters_.push_back(0);
    cell_at_.emplace(site, sites_.size());
    sites_.push_back(site);
    concentrations_.push_back(std::move(concentrations));
  }

  /// Sets all concentrations by the equation below.
  void regulate(double time) {
    std::vector<std::vector<double>> next;
    for (std::size_t cell = 0; cell < size(); ++cell) {
      const std::vector<double> inputs = inputs_of(cell, time);
      std::vector<double>& sums = next.emplace_back(products_);
      for (const float* gene = genome_.data(); gene != genome_.data() + genome_.size(); gene += Gene::size)
        sums[static_cast<std::size_t>(gene[Gene::product])] +=
            gene[Gene::weight_a] * inputs[static_cast<std::size_t>(gene[Gene::input_a])] +
            gene[Gene::weight_b] * inputs[static_cast<std::size_t>(gene[Gene::input_b])] + gene[Gene::bias];
      for (std::size_t p = 0; p < products_; ++p)
        if (genes_of_[p] > 0) sums[p] = std::tanh(sums[p] / std::sqrt(genes_of_[p]));
    }
    concentrations_ = std::move(next);
  }

  /// Returns the products of a cell, then its surroundings.
  std::vector<double> inputs_of(std::size_t cell, double time) const {
    std::vector<double> inputs = concentrations_[cell];
    inputs.resize(products_ + surroundings);
    double signals = 0, count = 0;
    for_each_beside(cell, [&](std::size_t other) {
      signals += concentrations_[other][products];
      ++count;
    });
    const Site& site = sites_[cell];
    inputs[products_ + neighbours] = count > 0 ? signals / count : 0;
    inputs[products_ + room] = 1 - count / double(ways.size());
    inputs[products_ + time_gone] = time;
    // gradients that the egg brings along, as morphogens of the mother: 0 where the first cell is, and -1 to 1
    for (std::size_t axis = 0; axis < 3; ++axis) inputs[products_ + x + axis] = std::tanh(site[axis] / 4.0);
    return inputs;
  }

  void divide_cells(std::size_t most_cells) {
    const std::size_t cells = size();  // daughters divide from the next step on
    for (std::size_t cell = 0; cell < cells && size() < most_cells; ++cell)
      if (concentrations_[cell][divide] > 0)
        if (const auto place = free_place(cell))
          add(*place, std::vector<double>(concentrations_[cell]),
              evodevo::mixed(identities_[cell], daughters_[cell]++));
  }

  /// Returns the free site beside a cell that is nearest to the direction in which it divides; of equal sites, the one
  /// nearest to the first cell; of these, the first in the order of `ways`.
  std::optional<Site> free_place(std::size_t cell) const {
    const std::vector<double>& c = concentrations_[cell];
    std::optional<Site> best;
    std::pair<double, int> most;
    for (const Site& way : ways) {
      const Site site = beside(sites_[cell], way);
      if (cell_at_.contains(site)) continue;
      const std::pair key(way[0] * c[to_x] + way[1] * c[to_y] + way[2] * c[to_z],
                          -(site[0] * site[0] + site[1] * site[1] + site[2] * site[2]));
      if (best && !(key > most)) continue;
      best = site;
      most = key;
    }
    return best;
  }

  const Genome& genome_;
  std::size_t products_;
  std::vector<double> genes_of_;  ///< number of genes that make each product
  std::vector<Site> sites_;
  std::vector<std::vector<double>> concentrations_;
  std::vector<std::uint64_t> identities_, daughters_;  ///< daughters_: the number of daughters of each cell
  std::map<Site, std::size_t> cell_at_;
};

/// A genome is a list of regulatory genes, as in the artificial embryos of Joachimczak and Wróbel (2012, "Co-evolution
/// of morphology and control of soft-bodied multicellular animats"). Each gene makes one product p, regulated by two
/// inputs; its concentration c_p follows from all n_p genes that make it:
///
///   c_p  <-  tanh( sum of (weight_a input_a + weight_b input_b + bias) / sqrt(n_p) ),  0 if n_p = 0
///
///   inputs:    the cell's own products; mean signal of the cells beside it; fraction of the sites beside it that are
///              free; time, from 0 to 1; where the cell is: tanh(x/4), tanh(y/4), tanh(z/4) in units of the lattice
///   products:  divide; where to (x, y, z); adhesion; signal; what else the cell remembers; each material
///
/// Cells lie on a face-centred cubic lattice, on which each has up to twelve others beside it. A cell divides if
/// `divide` is above 0 and there is a free site beside it; its daughter starts with the same concentrations. Cells
/// beside each other are joined unless their adhesion differs by more than 1: cells that are too different sort out. A
/// cell has the material with the largest concentration, the first of equals.
///
/// Cells become masses. Their signal and the products after it are what they remember at birth, under the names that
/// `regulated-growth` uses, so that development does not end at birth.
class Regulatory final : public evodevo::Encoding {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.integer(cells_, "cells", {2, 100'000, "1"}, "Largest number of cells, each of which becomes a mass.");
    p.integer(steps_, "steps", {1, 1000, "1"},
              "Number of steps of the embryo, in each of which every cell can divide.");
    p.real(spacing_, "spacing", {0.001, 100, "m"}, "Distance of neighbouring cells.");
    p.materials(materials_, "materials", "Materials that a cell may have; an empty list stands for all.");
    p.integer(memory_, "memory", {1, 16, "1"},
              "Number of products that masses remember at birth; as `memory` of regulated-growth.");
    p.integer(genes_, "genes", {1, 1000, "1"}, "Number of regulatory genes in first genomes.");
    p.integer(most_genes_, "most_genes", {1, 10'000, "1"}, "Largest number of regulatory genes.");
    p.require(genes_ <= most_genes_, "genes", "expected at most `most_genes`");
  }

  evodevo::Layout layout(const evodevo::EncodingContext& context) const override {
    const auto made = static_cast<std::uint32_t>(products_for(context));
    const auto inputs = made + static_cast<std::uint32_t>(surroundings);
    evodevo::Layout layout;
    const auto gene = layout.add_type({"gene",
                                       {{0, 0, made}, {0, 0, inputs}, {-3, 3}, {0, 0, inputs}, {-3, 3}, {-3, 3}},
                                       1,
                                       static_cast<std::uint32_t>(most_genes_),
                                       {"product", "input a", "weight a", "input b", "weight b", "bias"}});
    layout.types[gene].name_options(Gene::product, product_names(context));
    for (const std::size_t input : {Gene::input_a, Gene::input_b})
      layout.types[gene].name_options(input, input_names(context));
    for (std::int64_t i = 0; i < genes_; ++i) layout.add_block_of(gene);
    return layout;
  }

  evodevo::Blueprint decode(const Genome& genome, const evodevo::Layout&,
                            const evodevo::EncodingContext& context) const override {
    const auto materials = context.material_indices(materials_);
    if (auto reason = why_no_body(context, materials); !reason.empty()) return {{}, 0, reason};
    Embryo embryo(genome, products_for(context));
    embryo.grow(steps_, static_cast<std::size_t>(cells_));
    evodevo::Blueprint blueprint;
    blueprint.body.materials = context.materials;
    for (std::size_t cell = 0; cell < embryo.size(); ++cell)
      blueprint.body.masses.push_back(
          {place_of(embryo.site(cell)), context.mass, material_of(embryo, cell, materials)});
    join(embryo, blueprint.body);
    blueprint.origins.assign(embryo.size(), Vec3{});  // they all come from one cell
    blueprint.mass_memory = memories(embryo);
    blueprint.identities = embryo.identities();
    return blueprint;
  }

 private:
  std::size_t memory() const { return static_cast<std::size_t>(memory_); }
  std::size_t products_for(const evodevo::EncodingContext& context) const {
    return products + memory() + context.material_indices(materials_).size();
  }

  /// Returns the names of all products, in their order.
  std::vector<std::string> product_names(const evodevo::EncodingContext& context) const {
    std::vector<std::string> names = {"divide", "to x", "to y", "to z", "adhesion"};
    for (std::size_t m = 0; m < memory(); ++m) names.push_back(memory_name(m));
    for (const std::string& material : names_of(context, context.material_indices(materials_)))
      names.push_back("material " + material);
    return names;
  }

  /// Returns the names of all inputs: the products, then the surroundings.
  std::vector<std::string> input_names(const evodevo::EncodingContext& context) const {
    std::vector<std::string> names = product_names(context);
    for (const char* name : {"signal beside", "free sites", "time", "x", "y", "z"}) names.emplace_back(name);
    return names;
  }

  /// Returns the name under which masses remember a product.
  static std::string memory_name(std::size_t m) { return m == 0 ? "signal" : "memory " + std::to_string(m); }

  Vec3 place_of(const Site& site) const {
    return spacing_ / std::sqrt(2) * Vec3{double(site[0]), double(site[1]), double(site[2])};
  }

  std::int32_t material_of(const Embryo& embryo, std::size_t cell, const std::vector<std::int32_t>& materials) const {
    const auto concentration = [&](std::size_t i) { return embryo.concentration(cell, products + memory() + i); };
    std::size_t most = 0;
    for (std::size_t i = 1; i < materials.size(); ++i)
      if (concentration(i) > concentration(most)) most = i;
    return materials[most];
  }

  void join(const Embryo& embryo, evodevo::Body& body) const {
    for (std::size_t a = 0; a < embryo.size(); ++a)
      embryo.for_each_beside(a, [&](std::size_t b) {
        if (b < a || std::abs(embryo.concentration(a, adhesion) - embryo.concentration(b, adhesion)) > 1) return;
        const auto between = material_between(body, body.masses[a].material, body.masses[b].material);
        body.springs.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), spacing_,
                                body.material_index(between.value())});
      });
  }

  std::map<std::string, std::vector<double>> memories(const Embryo& embryo) const {
    std::map<std::string, std::vector<double>> memories;
    for (std::size_t m = 0; m < memory(); ++m) {
      std::vector<double>& of_cells = memories[memory_name(m)];
      for (std::size_t cell = 0; cell < embryo.size(); ++cell)
        of_cells.push_back(embryo.concentration(cell, products + m));
    }
    return memories;
  }

  std::int64_t cells_ = 300;
  std::int64_t steps_ = 30;
  double spacing_ = 0.2;  ///< m
  std::vector<std::string> materials_;
  std::int64_t memory_ = 2;
  std::int64_t genes_ = 32, most_genes_ = 128;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Regulatory>("regulatory",
                                                   "Cells divide from one cell, become different and adhere to each "
                                                   "other, as regulatory genes say (Joachimczak and Wróbel 2012)."))
