// A scene as a page of the viewer holds it.
#pragma once

#include <nlohmann/json.hpp>

#include "report/filming.hpp"

namespace evodevo {

/// What is seen of the scene that lives were filmed in.
///
///   floor, water   whether they are there
///   slope          how far gravity leans, degrees
///   ground         null where it is level; else heights around the films, at corners of squares: x and y of the first
///                  (m), spacing (m), columns (along x) and rows, roughness (m), and heights: 0 ... 254 for lowest to
///                  highest, row by row, packed as differences
nlohmann::ordered_json scene_json(const Scene& scene, const std::vector<FilmedLife>& lives);

}  // namespace evodevo
