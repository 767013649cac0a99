// "A direct encoding where each spring held its own material" (paper, section II).
#include "evodevo/helpers/lattice_encoding.hpp"
#include "evodevo/plugin.hpp"

namespace {

/// Each spring of a lattice has one gene, its material. The springs with the same first mass form one block.
class Direct final : public evodevo::LatticeEncoding {
 public:
  evodevo::Layout layout(const evodevo::EncodingContext& context) const override {
    const evodevo::Lattice& lattice = this->lattice();
    evodevo::Layout layout;
    for (std::size_t first = 0, last = 0; first < lattice.springs.size(); first = last) {
      while (last < lattice.springs.size() && lattice.springs[last].a == lattice.springs[first].a) ++last;
      layout.add_block(static_cast<std::uint32_t>(last - first), choice(context), "springs");
    }
    layout.types.front().gene_names = {"material"};
    return layout;
  }

  evodevo::Blueprint decode(const evodevo::Genome& genome, const evodevo::Layout&,
                            const evodevo::EncodingContext& context) const override {
    const auto materials = chosen(context);
    if (auto reason = why_no_body(context, materials); !reason.empty()) return {{}, 0, reason};
    const evodevo::Lattice& lattice = this->lattice();
    evodevo::Blueprint blueprint{masses(lattice, context), 0, {}};
    for (std::size_t s = 0; s < lattice.springs.size(); ++s)
      join(blueprint.body, lattice.springs[s], context.materials[materials[static_cast<std::size_t>(genome[s])]]);
    return blueprint;
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Direct>("direct",
                                               "Every spring of a block of voxels has its own material (paper, "
                                               "section II)."))
