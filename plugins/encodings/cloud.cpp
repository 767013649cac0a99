// A body whose places are given, in the form of a surface or of a cloud of points, and whose materials evolve.
#include <limits>
#include <stdexcept>

#include "evodevo/helpers/materials.hpp"
#include "evodevo/plugin.hpp"
#include "shape.hpp"

namespace {

using evodevo::Shape;
using evodevo::Vec3;

/// The masses lie in the volume that a surface encloses, or at the points of a cloud. Each has the material of the
/// nearest site (Voronoi 1908), so that bodies have patches of material. Mutations such as add-block and remove-block
/// let sites come and go.
class Cloud final : public evodevo::Encoding {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.file(file_, "file",
           "PLY, OBJ or STL file with a closed surface, whose volume is filled with masses, or, if it has no faces, "
           "with a cloud of points, which become masses.");
    p.choice(up_, "up", {"x", "y", "z"},
             "Axis of the file that points up in the world; files of animals often have y.");
    p.integer(points_, "points", {4, 100'000, "1"},
              "Number of masses in the volume, or largest number of points of a cloud that become masses.");
    p.integer(points_seed_, "points_seed", {0, 4294967295.0, "1"},
              "Seed of the random points in the volume, or of the choice among the points of a cloud.");
    p.integer(neighbours_, "neighbours", {1, 1000, "1"}, "Number of nearest neighbours that every mass is joined to.");
    p.real(side_, "side", {0.001, 1000, "m"}, "Longest side of the bounding box of the surface or the cloud.");
    p.materials(materials_, "materials", "Materials that a site may have; an empty list stands for all.");
    p.integer(sites_, "sites", {1, 10'000, "1"},
              "Number of sites in first genomes; a mass has the nearest's material.");
    p.integer(most_sites_, "most_sites", {1, 10'000, "1"}, "Largest number of sites.");
    p.require(!file_.path.empty(), "file", "expected a PLY, OBJ or STL file");
    p.require(sites_ <= most_sites_, "sites", "expected at most `most_sites`");
  }

  /// Reads the file and draws the places of the masses. This takes time in proportion to points times triangles: 30 ms
  /// for 1,000 points in half of the bounding box and 500 triangles. Throws std::invalid_argument if the file gives no
  /// body.
  void prepare(const evodevo::EncodingContext& context) override {
    const Shape shape = read_shape(file_, up_);
    evodevo::Rng rng = context.rng(static_cast<std::uint64_t>(points_seed_));
    places_ = shape.triangles.empty() ? chosen(shape.points, rng) : filled(shape, rng);
    half_ = shape.half;
  }

  evodevo::Layout layout(const evodevo::EncodingContext& context) const override {
    const auto chosen = context.material_indices(materials_);
    const auto materials = static_cast<std::uint32_t>(chosen.size());
    evodevo::Layout layout;
    const auto site = layout.add_type({"site",
                                       {{-1, 1}, {-1, 1}, {-1, 1}, {0, 0, std::max(1u, materials)}},
                                       1,
                                       static_cast<std::uint32_t>(most_sites_),
                                       {"x", "y", "z", "material"}});
    layout.types[site].name_options(site_material, names_of(context, chosen));
    for (std::int64_t i = 0; i < sites_; ++i) layout.add_block_of(site);
    return layout;
  }

  evodevo::Blueprint decode(const evodevo::Genome& genome, const evodevo::Layout&,
                            const evodevo::EncodingContext& context) const override {
    const auto materials = context.material_indices(materials_);
    if (auto reason = why_no_body(context, materials); !reason.empty()) return {{}, 0, reason};
    evodevo::Blueprint blueprint;
    blueprint.origins = places_;
    blueprint.body.materials = context.materials;
    blueprint.neighbours = static_cast<std::uint32_t>(neighbours_);
    for (const Vec3& place : places_) {
      const float* site = nearest_site(genome, place);
      blueprint.body.masses.push_back(
          {side_ / 2 * place, context.mass, materials[static_cast<std::size_t>(site[site_material])]});
    }
    return blueprint;
  }

 private:
  /// Most winding numbers of a triangle that prepare() computes; this many take about 30 s.
  static constexpr std::size_t most_work = 1'000'000'000;
  /// Positions of the genes of a site. Its coordinates are relative to half of the sides of the bounding box.
  enum Gene : std::uint32_t { site_x, site_y, site_z, site_material, site_genes };

  const float* nearest_site(const evodevo::Genome& genome, Vec3 place) const {
    const float* nearest = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const float* site = genome.data(); site != genome.data() + genome.size(); site += site_genes) {
      const Vec3 way = place - Vec3{half_.x * site[site_x], half_.y * site[site_y], half_.z * site[site_z]};
      if (nearest != nullptr && !(dot(way, way) < least)) continue;
      least = dot(way, way);
      nearest = site;
    }
    return nearest;
  }

  std::vector<Vec3> chosen(std::vector<Vec3> points, evodevo::Rng& rng) const {
    if (points.size() <= static_cast<std::size_t>(points_)) return points;
    rng.shuffle(points);
    points.resize(static_cast<std::size_t>(points_));
    return points;
  }

  std::vector<Vec3> filled(const Shape& shape, evodevo::Rng& rng) const {
    const Vec3 half = shape.half;
    std::vector<Vec3> inside;
    for (std::size_t tries = 1; inside.size() < static_cast<std::size_t>(points_); ++tries) {
      const double x = rng.uniform(-half.x, half.x), y = rng.uniform(-half.y, half.y);
      const Vec3 place{x, y, rng.uniform(-half.z, half.z)};
      if (winding_number(shape, place) > 0.5) inside.push_back(place);
      if (tries * shape.triangles.size() > most_work)
        throw std::invalid_argument(file_.path + ": to fill a surface of " + std::to_string(shape.triangles.size()) +
                                    " triangles with " + std::to_string(points_) +
                                    " points takes too long; expected fewer triangles or points");
      if (tries >= 10'000 && inside.size() < tries / 400) {
        const std::string fault = surface_fault(shape);
        throw std::invalid_argument(file_.path + ": the surface " +
                                    (fault.empty() ? "encloses less than 0.5 % of its bounding box" : fault) +
                                    "; expected a closed surface whose faces are anticlockwise as seen from outside");
      }
    }
    return inside;
  }

  evodevo::InputFile file_;
  std::string up_ = "z";
  std::int64_t points_ = 1000;
  std::int64_t points_seed_ = 1;
  std::int64_t neighbours_ = 25;
  double side_ = 2;
  std::vector<std::string> materials_;
  std::int64_t sites_ = 12;
  std::int64_t most_sites_ = 48;
  std::vector<Vec3> places_;  ///< of the masses, relative to half of the longest side; equal in all bodies of a run
  Vec3 half_;                 ///< half of the sides of the bounding box, in the same unit
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Cloud>("cloud",
                                              "Masses fill a given surface or lie at given points, and each has the "
                                              "material of the nearest of several sites that evolve."))
