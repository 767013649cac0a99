// "A voxel encoding where a cube of springs shared a material" (paper, section II).
#include "evodevo/plugin.hpp"
#include "lattice_encoding.hpp"

namespace {

using evodevo::Material;

/// One gene for each voxel; voxels of air are absent. A spring between several voxels has the mean of their materials.
class Voxel final : public LatticeEncoding {
 public:
  evodevo::Layout layout(const evodevo::World& world) const override {
    evodevo::Layout layout;
    for (std::uint32_t v = 0; v < lattice().voxels(); ++v) layout.add_group(1, choice(world));
    return layout;
  }

  evodevo::Blueprint decode(const evodevo::Genome& genome, const evodevo::World& world) const override {
    const auto materials = chosen(world);
    if (auto reason = why_no_body(world, materials); !reason.empty()) return {{}, 0, reason};
    const evodevo::Lattice lattice = this->lattice();
    evodevo::Blueprint blueprint{masses(lattice, world), 0, {}};
    for (const evodevo::LatticeSpring& spring : lattice.springs) {
      std::vector<std::int32_t> around;
      for (const std::uint32_t v : spring.voxels) around.push_back(materials[static_cast<std::size_t>(genome[v])]);
      join(blueprint.body, spring, mean_of_solid(world.materials, std::move(around)));
    }
    return blueprint;
  }

 private:
  /// The mean of those that are not air; air where there are none. Equal shares give equal bits and one material alone
  /// is not rounded, so that a body needs few different materials.
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
    }
    return mean;
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Voxel>("voxel",
                                              "Every voxel of a block has one material or is air, and springs take "
                                              "the mean of their voxels (paper, section II)."))
