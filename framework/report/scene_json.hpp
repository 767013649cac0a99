// Scenes in the format of the viewer's pages.
#pragma once

#include <nlohmann/json.hpp>

#include "report/film_json.hpp"

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

/// Returns how near a filmed robot came to the top speed of its scene (top_speed() in life/measurement/top_speed.hpp),
/// or null if more than friction can push robots there, or the robot was not measured. `titles` are those of the shots.
///
///   length   the robot's longest side when its measurement began, m
///   speed    horizontal distance from where its centre of mass was then to where it was in the end, by the time, m/s
///   limit    top speed in this direction, m/s; null if nothing but the muscles limits the speed
nlohmann::ordered_json top_speed_json(const Scene& scene, const Film& film, const std::vector<Title>& titles);

}  // namespace evodevo
