// For encodings on a lattice of voxels (paper, section II: the authors' earlier encodings).
#pragma once

#include "evodevo/encoding.hpp"
#include "evodevo/helpers/materials.hpp"
#include "evodevo/lattice.hpp"

namespace evodevo {

/// A lattice whose corners are masses without a material. The genes determine the materials of its springs.
class LatticeEncoding : public Encoding {
 public:
  void parameters(Parameters& p) override {
    p.counts(size_, "size", {1, 32, "1"}, "Number of voxels along x, y and z.");
    p.real(edge_, "edge", {0.001, 100, "m"}, "Edge length of a voxel.");
    p.materials(materials_, "materials", "Materials that genes choose from; an empty list stands for all.");
  }

  /// Makes the lattice, which is the same for all bodies.
  void prepare(const EncodingContext&) override {
    lattice_ = make_lattice({static_cast<std::uint32_t>(size_[0]), static_cast<std::uint32_t>(size_[1]),
                             static_cast<std::uint32_t>(size_[2])},
                            edge_);
  }

 protected:
  const Lattice& lattice() const { return lattice_; }

  std::vector<std::int32_t> chosen(const EncodingContext& context) const {
    return context.material_indices(materials_);
  }

  /// Returns the description of a gene that chooses a material. The gene has at least one option, because a gene with
  /// no options would be a real gene.
  GeneSpec choice(const EncodingContext& context) const {
    return {0, 0, std::max(1u, static_cast<std::uint32_t>(chosen(context).size()))};
  }

  /// Returns a body that consists of the lattice's masses, centred on the origin, without springs.
  Body masses(const Lattice& lattice, const EncodingContext& context) const {
    Body body;
    body.materials = context.materials;
    const Vec3 centre = 0.5 * lattice.corners.back();
    for (const Vec3& corner : lattice.corners) body.masses.push_back({corner - centre, context.mass});
    return body;
  }

  /// Adds a spring of the lattice to the body, with the given material. If the material is air, counts a contact with
  /// air for both masses instead, and returns false.
  static bool join(Body& body, const LatticeSpring& spring, const Material& material) {
    Mass &a = body.masses[spring.a], &b = body.masses[spring.b];
    if (is_air(material)) {
      ++a.air_contacts;
      ++b.air_contacts;
      return false;
    }
    body.springs.push_back({spring.a, spring.b, norm(b.rest - a.rest), body.material_index(material)});
    return true;
  }

 private:
  std::array<std::int64_t, 3> size_ = {4, 4, 4};
  double edge_ = 0.1;
  std::vector<std::string> materials_;
  Lattice lattice_;
};

}  // namespace evodevo
