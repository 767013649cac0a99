// Films in the format of the viewer's pages.
#pragma once

#include <nlohmann/json.hpp>

#include "report/filming.hpp"

namespace evodevo {

/// Largest deviations of what the page shows from what was simulated.
struct ViewError {
  double largest = 0;  ///< largest error of a position over all masses and all filmed frames, m
  double most = 0;     ///< 99th percentile of the errors of positions, m
  double stress = 0;   ///< largest error of a stress, N
};

/// The title of a shot.
struct Title {
  std::string name;
  bool measured = false;  ///< whether the shot lies within the window of a fitness
};

/// Converts a film to JSON of at most `budget` bytes, if possible. Masses and springs keep their numbers throughout the
/// life. If the film is too large, frames are left out (fewer from measured shots than from others), and positions and
/// stress are stored with lower precision. The masses and springs of each shot, and the first and the last frame of
/// each shot, are always kept, even if they exceed the budget. `titles` has one title for each shot. The JSON of an
/// empty film has only an empty list of shots.
///
///   masses          number of masses that are ever in the body
///   mass_materials  material of each mass; packed (packing.hpp), as are all lists of numbers below except times
///   ends            the two masses of each spring
///   materials       properties of the materials, those of the experiment first
///   most_stress     largest stress in the film, N
///   stress_levels   number of levels of stress; level = stress_levels * sqrt(stress / most_stress)
///   step            unit of positions, m
///   rest_step       unit of rest lengths, m
///   error           ViewError, with positions interpolated linearly between the frames kept
///   shots           for each shot: name; times (s); masses and springs: the numbers of those that were added or
///                   removed since the previous shot; materials, rest_lengths (those at the beginning of the shot) and
///                   stress: of the springs present, in the order of their numbers; positions: those of the masses
///                   present
nlohmann::ordered_json film_json(const Film& film, const std::vector<Title>& titles, std::size_t budget);

}  // namespace evodevo
