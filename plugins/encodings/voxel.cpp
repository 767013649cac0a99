// "A voxel encoding where a cube of springs shared a material" (paper, section II).
#include "evodevo/helpers/lattice_encoding.hpp"
#include "evodevo/plugin.hpp"

namespace {

using evodevo::Material;

/// Each voxel has one block of genes: its material, if `size_range` is above 0 its size, and if `phase_range` is above
/// 0 the phase of its muscles, the last two at birth and at the end of development (Kriegman et al. 2017 and 2018; in
/// the paper's words, "a start and end volume"). Voxels of air are absent. A spring that belongs to several voxels has
/// the mean of their materials, sizes and phases, or each voxel has springs of its own. The positions of the
/// masses at birth are those of a lattice of equal voxels. If genes are mirrored, only the voxels of the half with the
/// smaller x have them.
class Voxel final : public evodevo::LatticeEncoding {
 public:
  void parameters(evodevo::Parameters& p) override {
    LatticeEncoding::parameters(p);
    p.real(size_range_, "size_range", {0, 0.9, "1"},
           "Largest fraction by which a voxel can be larger or smaller than its edge, at birth and, with "
           "ballistic-growth, at the end of development; 0: no genes for this.");
    p.real(phase_range_, "phase_range", {0, 1, "turns"},
           "Largest phase that a voxel adds to that of its material, forwards or backwards, at birth and, with "
           "ballistic-phase, at the end of development; 0: no genes for this.");
    p.flag(grows_, "grows",
           "Whether voxels have genes of their own for size and phase at the end of development; otherwise both stay "
           "as at birth.");
    p.choice(springs_, "springs", {"shared", "own"},
             "Whether voxels share the springs between their common corners, or each voxel has springs of its own, "
             "which act in parallel to those of its neighbours, and an eighth of the mass at each of its corners.");
    p.choice(mirrored_, "mirrored", {"nothing", "body", "all"},
             "Which genes voxels share with their mirror images across the plane through the middle at right angles to "
             "x: none, those of material and size, or those of the phase, too.");
  }

  evodevo::Layout layout(const evodevo::EncodingContext& context) const override {
    const auto size = static_cast<float>(size_range_), phase = static_cast<float>(phase_range_);
    evodevo::Layout layout;
    std::vector<evodevo::GeneSpec> phases(phase > 0 ? moments() : 0, {-phase, phase}), all = phases;
    all.push_back(choice(context));
    all.insert(all.end(), size > 0 ? moments() : 0, {1 - size, 1 + size});
    for (std::uint32_t v = 0; v < lattice().voxels(); ++v) {
      if (owns_body(v))
        layout.add_block(all, "voxel");
      else if (owns_phase(v) && !phases.empty())
        layout.add_block(phases, "mirrored voxel");
    }
    for (evodevo::BlockType& type : layout.types) {
      type.gene_names = gene_names();
      if (type.genes.size() > phases.size()) type.name_options(phases.size(), names_of(context, chosen(context)));
    }
    return layout;
  }

  evodevo::Blueprint decode(const evodevo::Genome& genome, const evodevo::Layout&,
                            const evodevo::EncodingContext& context) const override {
    const auto materials = chosen(context);
    if (auto reason = why_no_body(context, materials); !reason.empty()) return {{}, 0, reason};
    const evodevo::Lattice& lattice = this->lattice();
    const std::vector<Traits> voxels = traits_of_voxels(genome, materials);
    evodevo::Blueprint blueprint{masses(lattice, context), 0, {}};
    blueprint.parallel = springs_ == "own";
    const auto is_solid = [&](std::uint32_t v) { return !is_air(context.materials[voxels[v].material]); };
    if (blueprint.parallel) share_out_mass(blueprint.body, is_solid);
    for (const evodevo::LatticeSpring& spring : lattice.springs) {
      if (blueprint.parallel && std::ranges::any_of(spring.voxels, is_solid)) {
        for (const std::uint32_t v : spring.voxels)
          if (is_solid(v)) add_spring(blueprint, spring, {&v, 1}, voxels, context);
      } else {
        add_spring(blueprint, spring, spring.voxels, voxels, context);
      }
    }
    return blueprint;
  }

  std::vector<std::string> spring_memory() const override {
    std::vector<std::string> names;
    if (grows_ && size_range_ > 0) names.push_back("growth");
    if (grows_ && phase_range_ > 0) names.push_back("turn");
    return names;
  }

 private:
  static constexpr double full_turn = 2 * 3.14159265358979323846;

  /// A size or a phase at birth and at the end of development, or the sum of several.
  struct Course {
    double birth = 0, end = 0;
    int count = 0;  ///< of those that were added

    void add(const Course& other) {
      birth += other.birth;
      end += other.end;
      ++count;
    }
  };

  struct Traits {
    std::int32_t material = 0;
    Course size{1, 1}, phase;  ///< relative to the edge; turns
  };

  /// The number of genes for a size or a phase.
  std::size_t moments() const { return grows_ ? 2 : 1; }
  /// Whether a voxel has genes of its own for material and size, and for its phase.
  bool owns_body(std::uint32_t v) const { return mirrored_ == "nothing" || v <= lattice().mirrored_voxel(v); }
  bool owns_phase(std::uint32_t v) const { return mirrored_ != "all" || v <= lattice().mirrored_voxel(v); }

  std::vector<std::string> gene_names() const {
    std::vector<std::string> names;
    const auto add = [&](const std::string& name) {
      names.push_back(name + " at birth");
      if (grows_) names.push_back(name + " at the end");
    };
    if (phase_range_ > 0) add("phase");
    names.push_back("material");
    if (size_range_ > 0) add("size");
    return names;
  }

  /// Adds a spring with the mean traits of some voxels, unless all of them are air.
  void add_spring(evodevo::Blueprint& blueprint, const evodevo::LatticeSpring& spring,
                  std::span<const std::uint32_t> of, const std::vector<Traits>& voxels,
                  const evodevo::EncodingContext& context) const {
    std::vector<std::int32_t> around;
    Course size, phase;
    for (const std::uint32_t v : of) {
      around.push_back(voxels[v].material);
      if (is_air(context.materials[around.back()])) continue;
      size.add(voxels[v].size);
      phase.add(voxels[v].phase);
    }
    Material material = mean_of_solid(context.materials, std::move(around));
    const bool is_muscle = material.amplitude != 0;
    if (is_muscle) material.phase += phase.birth / size.count * full_turn;
    if (!join(blueprint.body, spring, material)) return;
    blueprint.body.springs.back().rest_length *= size.birth / size.count;
    if (!grows_) return;
    const double turn = is_muscle ? (phase.end - phase.birth) / phase.count * full_turn : 0;
    if (size_range_ > 0)
      blueprint.spring_memory["growth"].push_back(double{static_cast<float>(size.end / size.birth)} - 1);
    if (phase_range_ > 0) blueprint.spring_memory["turn"].push_back(double{static_cast<float>(turn)});
  }

  /// Gives each mass an eighth of its mass for each solid voxel of which it is a corner; other masses, which have no
  /// springs, keep theirs.
  void share_out_mass(evodevo::Body& body, const auto& is_solid) const {
    std::vector<int> solid(body.masses.size());
    for (const evodevo::LatticeSpring& spring : lattice().springs) {
      // each corner of a voxel is the end of one body diagonal
      if (!lattice().is_body_diagonal(spring) || !is_solid(spring.voxels.front())) continue;
      ++solid[spring.a];
      ++solid[spring.b];
    }
    for (std::size_t i = 0; i < solid.size(); ++i)
      if (solid[i] > 0) body.masses[i].mass *= solid[i] / 8.0;
  }

  std::vector<Traits> traits_of_voxels(const evodevo::Genome& genome,
                                       const std::vector<std::int32_t>& materials) const {
    const float* gene = genome.data();
    const auto read = [&](Course& course) {
      course.birth = *gene++;
      course.end = grows_ ? *gene++ : course.birth;
    };
    std::vector<Traits> voxels(lattice().voxels());
    for (std::uint32_t v = 0; v < voxels.size(); ++v) {
      const Traits& image = voxels[lattice().mirrored_voxel(v)];
      if (!owns_phase(v))
        voxels[v].phase = image.phase;
      else if (phase_range_ > 0)
        read(voxels[v].phase);
      if (!owns_body(v)) {
        voxels[v].material = image.material;
        voxels[v].size = image.size;
        continue;
      }
      voxels[v].material = materials[static_cast<std::size_t>(*gene++)];
      if (size_range_ > 0) read(voxels[v].size);
    }
    return voxels;
  }

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

  double size_range_ = 0, phase_range_ = 0;
  bool grows_ = true;
  std::string springs_ = "shared", mirrored_ = "nothing";
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Voxel>("voxel",
                                              "Every voxel of a block has one material or is air, and each spring has "
                                              "the mean material of its voxels (paper, section II)."))
