// Scenes in the format of the viewer's pages.
#pragma once

#include <nlohmann/json.hpp>

#include "report/filming.hpp"

namespace evodevo {

/// The region that films show.
class SeenRegion {
 public:
  /// Includes all positions in the films. Of a life that failed, only the first frame counts, because a diverging body
  /// may move arbitrarily far.
  void include(const std::vector<FilmedLife>& lives);
  /// Returns the region, m: the bounding box of all positions, extended horizontally by a margin.
  Box box() const;

 private:
  std::vector<Vec3> corners_;
  double side_ = 0;  ///< longest side of a body in a first frame, m
};

/// Returns what the viewer shows of the scene in which lives were filmed.
///
///   floor, water   whether the scene has a floor, and whether it has drag
///   slope          slope of the ground, degrees
///   ground         null if the ground is level, else a grid of heights of the region that the films show: x and y of
///                  the first point (m), spacing (m), columns (along x) and rows, roughness (m), and heights, from 0
///                  (lowest) to 254 (highest), row by row, packed as differences
nlohmann::ordered_json scene_json(const Scene& scene, const SeenRegion& region);

}  // namespace evodevo
