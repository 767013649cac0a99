// "A direct encoding where each spring held its own material" (paper, section II).
#include "evodevo/helpers/lattice_encoding.hpp"
#include "evodevo/plugin.hpp"

namespace {

/// Each spring of a lattice has one gene, its material. The springs with the same first mass form one block. If the
/// body is mirrored, a spring and its mirror image share the gene of the one that comes first.
class Direct final : public evodevo::LatticeEncoding {
 public:
  void parameters(evodevo::Parameters& p) override {
    LatticeEncoding::parameters(p);
    p.flag(mirrored_, "mirrored",
           "Whether bodies are symmetric across the plane through their middle at right angles to x: a spring and its "
           "mirror image share a gene.");
  }

  void prepare(const evodevo::EncodingContext& context) override {
    LatticeEncoding::prepare(context);
    const std::vector<evodevo::LatticeSpring>& springs = lattice().springs;
    for (std::uint32_t s = 0; s < springs.size(); ++s) owners_.push_back(mirrored_ ? std::min(s, mirrored(s)) : s);
  }

  evodevo::Layout layout(const evodevo::EncodingContext& context) const override {
    const std::vector<evodevo::LatticeSpring>& springs = lattice().springs;
    evodevo::Layout layout;
    for (std::uint32_t first = 0, last = 0; first < springs.size(); first = last) {
      std::uint32_t genes = 0;
      for (; last < springs.size() && springs[last].a == springs[first].a; ++last) genes += owners_[last] == last;
      if (genes > 0) layout.add_block(genes, choice(context), "springs");
    }
    layout.types.front().gene_names = {"material"};
    layout.types.front().name_options(0, names_of(context, chosen(context)));
    return layout;
  }

  evodevo::Blueprint decode(const evodevo::Genome& genome, const evodevo::Layout&,
                            const evodevo::EncodingContext& context) const override {
    const auto materials = chosen(context);
    if (auto reason = why_no_body(context, materials); !reason.empty()) return {{}, 0, reason};
    const evodevo::Lattice& lattice = this->lattice();
    evodevo::Blueprint blueprint{masses(lattice, context), 0, {}};
    std::vector<std::size_t> choices;  // of each spring, among the materials
    for (std::size_t s = 0, gene = 0; s < lattice.springs.size(); ++s) {
      choices.push_back(owners_[s] == s ? static_cast<std::size_t>(genome[gene++]) : choices[owners_[s]]);
      join(blueprint.body, lattice.springs[s], context.materials[materials[choices[s]]]);
    }
    return blueprint;
  }

 private:
  /// Returns the index of the spring that is the mirror image of another.
  std::uint32_t mirrored(std::uint32_t s) const {
    const std::vector<evodevo::LatticeSpring>& springs = lattice().springs;
    const auto ends = [](const evodevo::LatticeSpring& spring) { return std::pair(spring.a, spring.b); };
    const std::pair<std::uint32_t, std::uint32_t> image =
        std::minmax({lattice().mirrored_corner(springs[s].a), lattice().mirrored_corner(springs[s].b)});
    return static_cast<std::uint32_t>(std::ranges::lower_bound(springs, image, {}, ends) - springs.begin());
  }

  bool mirrored_ = false;
  std::vector<std::uint32_t> owners_;  ///< [springs] the spring whose gene decides
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Direct>("direct",
                                               "Every spring of a block of voxels has its own material (paper, "
                                               "section II)."))
