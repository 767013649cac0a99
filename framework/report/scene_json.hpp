// Scenes in the format of the viewer's pages.
#pragma once

#include <nlohmann/json.hpp>

#include "report/filming.hpp"

namespace evodevo {

/// Returns what the viewer shows of the scene in which lives were filmed.
///
///   floor, water   whether the scene has a floor, and whether it has drag
///   slope          slope of the ground, degrees
///   ground         null if the ground is level, else a grid of heights of the region that the films show: x and y of
///                  the first point (m), spacing (m), columns (along x) and rows, roughness (m), and heights, from 0
///                  (lowest) to 254 (highest), row by row, packed as differences
nlohmann::ordered_json scene_json(const Scene& scene, const std::vector<FilmedLife>& lives);

}  // namespace evodevo
