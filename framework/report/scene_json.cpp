#include "report/scene_json.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/ground.hpp"
#include "life/measurement/top_speed.hpp"
#include "report/packing.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;

constexpr double margin = 3;  ///< width of the ground shown around all bodies, relative to the largest body length
constexpr double samples_in_wavelength = 12;  ///< error of linear interpolation: at most 1/25 of the roughness
constexpr double most_samples = 256;          ///< largest number of samples along each side

Vec3 position(const SeenPlace& p) { return {p[0], p[1], p[2]}; }

std::vector<Vec3> positions_in(const Frame& frame) {
  std::vector<Vec3> positions;
  std::transform(frame.positions.begin(), frame.positions.end(), std::back_inserter(positions), position);
  return positions;
}

Json ground_json(const Scene& scene, const Box& box) {
  const double width = box.high.x - box.low.x, depth = box.high.y - box.low.y;
  const double spacing =
      std::max(scene.floor->wavelength / samples_in_wavelength, std::max(width, depth) / (most_samples - 1));
  const auto samples = [&](double length) { return static_cast<std::size_t>(std::ceil(length / spacing - 1e-9)) + 1; };
  const std::size_t columns = samples(width), rows = samples(depth);
  std::vector<std::uint32_t> heights;
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < columns; ++column) {
      const Vec3 at{box.low.x + static_cast<double>(column) * spacing, box.low.y + static_cast<double>(row) * spacing,
                    0};
      const double part = ground_height(scene, at) / scene.floor->roughness;
      heights.push_back(static_cast<std::uint32_t>(std::lround(127 * (1 + part))));
    }
  return {{"x", box.low.x},
          {"y", box.low.y},
          {"spacing", spacing},
          {"columns", columns},
          {"rows", rows},
          {"roughness", scene.floor->roughness},
          {"heights", packed_differences(heights)}};
}

}  // namespace

void SeenRegion::include(const std::vector<FilmedLife>& lives) {
  for (const FilmedLife& life : lives)
    for (const Shot& shot : life.film)
      for (const Frame& frame : shot.frames) {
        const bool first = &shot == &life.film.front() && &frame == &shot.frames.front();
        if (!first && life.result.status != Status::ok) continue;
        const Box box = bounding_box(positions_in(frame));
        if (first) side_ = std::max(side_, box.longest_side());
        corners_.insert(corners_.end(), {box.low, box.high});
      }
}

Box SeenRegion::box() const {
  const Box box = bounding_box(corners_);
  const Vec3 around{margin * side_, margin * side_, 0};
  return {box.low - around, box.high + around};
}

Json scene_json(const Scene& scene, const SeenRegion& region) {
  const bool rough = scene.floor && scene.floor->rough();
  return {{"floor", scene.floor.has_value()},
          {"water", scene.drag.has_value()},
          {"slope", scene.gravity ? scene.gravity->slope : 0.0},
          {"ground", rough ? ground_json(scene, region.box()) : Json(nullptr)}};
}

Json top_speed_json(const Scene& scene, const Film& film, const std::vector<Title>& titles) {
  const auto measured = std::ranges::find_if(titles, &Title::measured);
  if (!moves_by_friction(scene) || measured == titles.end()) return nullptr;
  const Shot& opening = film.at(static_cast<std::size_t>(measured - titles.begin()));
  const Frame &first = opening.frames.front(), &last = film.back().frames.back();
  const double time = last.time - first.time;
  if (!(time > 0)) return nullptr;
  const std::vector<Vec3> before = positions_in(first), after = positions_in(last);
  Vec3 way = centre_of_mass(film.back().body, after) - centre_of_mass(opening.body, before);
  way.z = 0;
  const double distance = norm(way), limit = top_speed(scene, distance > 0 ? way.x / distance : 0);
  return {{"length", bounding_box(before).longest_side()},
          {"speed", distance / time},
          {"limit", std::isinf(limit) ? Json(nullptr) : Json(limit)}};
}

}  // namespace evodevo
