// "A voxel encoding where a cube of springs shared a material" (paper, section II).
#include "evodevo/helpers/lattice_encoding.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Material;

/// Each voxel has one block of genes: its material and, if `size_range` is above 0, its size at birth and its size at
/// the end of development (Kriegman et al. 2017; in the paper's words, "a start and end volume"). Voxels of air are
/// absent. A spring that belongs to several voxels has the mean of their materials and sizes. The positions of the
/// masses at birth are those of a lattice of equal voxels.
class Voxel final : public evodevo::LatticeEncoding {
 public:
  void parameters(evodevo::Parameters& p) override {
    LatticeEncoding::parameters(p);
    p.real(size_range_, "size_range", {0, 0.9, "1"},
           "Largest fraction by which a voxel can be larger or smaller than its edge, at birth and, with "
           "ballistic-growth, at the end of development; 0: no genes for this.");
  }

  evodevo::Layout layout(const evodevo::EncodingContext& context) const override {
    std::vector<evodevo::GeneSpec> voxel = {choice(context)};
    if (size_range_ > 0) {
      const auto range = static_cast<float>(size_range_);
      voxel.insert(voxel.end(), 2, {1 - range, 1 + range});
    }
    evodevo::Layout layout;
    for (std::uint32_t v = 0; v < lattice().voxels(); ++v) layout.add_block(voxel, "voxel");
    layout.types.front().gene_names = {"material", "size at birth", "size at the end"};
    return layout;
  }

  evodevo::Blueprint decode(const evodevo::Genome& genome, const evodevo::Layout&,
                            const evodevo::EncodingContext& context) const override {
    const auto materials = chosen(context);
    if (auto reason = why_no_body(context, materials); !reason.empty()) return {{}, 0, reason};
    const evodevo::Lattice& lattice = this->lattice();
    const std::size_t genes = size_range_ > 0 ? 3 : 1;
    evodevo::Blueprint blueprint{masses(lattice, context), 0, {}};
    for (const evodevo::LatticeSpring& spring : lattice.springs) {
      std::vector<std::int32_t> around;
      Sizes sizes;
      for (const std::uint32_t v : spring.voxels) {
        const float* voxel = &genome[genes * v];
        around.push_back(materials[static_cast<std::size_t>(voxel[0])]);
        if (size_range_ > 0 && !is_air(context.materials[around.back()])) sizes.add(voxel[1], voxel[2]);
      }
      if (join(blueprint.body, spring, mean_of_solid(context.materials, std::move(around))) && size_range_ > 0)
        sizes.apply(blueprint.body.springs.back());
    }
    return blueprint;
  }

  bool sets_growth() const override { return size_range_ > 0; }

 private:
  /// The sum of the sizes of the solid voxels that a spring belongs to.
  struct Sizes {
    double start = 0, end = 0;
    int count = 0;

    void add(float voxel_start, float voxel_end) {
      start += voxel_start;
      end += voxel_end;
      ++count;
    }
    void apply(evodevo::Spring& spring) const {
      spring.rest_length *= start / count;
      spring.growth = static_cast<float>(end / start);
    }
  };

  /// Returns the mean of the materials that are not air, or air if there are none. `indices` has one entry for each
  /// voxel. The same mixture always gives the same bits, and the mean of a single material is exactly that material, so
  /// that a body has few different materials.
  static Material mean_of_solid(const std::vector<Material>& materials, std::vector<std::int32_t> indices) {
    std::erase_if(indices, [&](std::int32_t i) { return is_air(materials[i]); });
    std::sort(indices.begin(), indices.end());
    Material mean;
    for (auto next = indices.begin(); next != indices.end();) {
      const Material& material = materials[*next];
      const auto equal = std::count(indices.begin(), indices.end(), *next);
      next += equal;
      const double share = static_cast<double>(equal) / static_cast<double>(next - indices.begin());
      mean.stiffness += share * (material.stiffness - mean.stiffness);
      mean.amplitude += share * (material.amplitude - mean.amplitude);
      mean.frequency += share * (material.frequency - mean.frequency);
      mean.phase += share * (material.phase - mean.phase);
      mean.damping += share * (material.damping - mean.damping);
    }
    return mean;
  }

  double size_range_ = 0;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Voxel>("voxel",
                                              "Every voxel of a block has one material or is air, and each spring has "
                                              "the mean material of its voxels (paper, section II)."))
