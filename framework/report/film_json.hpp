// A film as a page of the viewer holds it.
#pragma once

#include <nlohmann/json.hpp>

#include "report/filming.hpp"

namespace evodevo {

/// How far what the page shows may be from what was simulated.
struct ViewError {
  double largest = 0;  ///< over all masses and filmed moments, m
  double most = 0;     ///< of 99 in 100, m
  double stress = 0;   ///< N
};

/// What a shot shows.
struct Title {
  std::string name;
  bool measured = false;  ///< within the window of a fitness
};

/// A film as JSON: its springs and masses numbered through the whole life, the shots with who is there, the springs'
/// materials and stress, and the positions, in such detail that all takes at most `budget` bytes: frames are left out,
/// fewer of measured shots than of others, and positions and stress get coarser. Who is there, and the first and the
/// last frame of each shot, are never left out, whatever they take. `titles` are those of the shots. A film without
/// shots gives none.
///
///   masses          how many there ever are
///   mass_materials  of each; packed like all that follows in numbers
///   ends            of each spring, two masses
///   materials       what they do, those of the experiment first
///   most_stress     N
///   stress_levels   into which the root of stress up to the most is divided
///   step            unit of positions, m
///   error           ViewError of straight lines between the frames kept
///   shots           name, times (s), masses and springs (numbers of those that came or went), materials and stress
///                   of the springs present, in the order of their numbers, positions of the masses present
nlohmann::ordered_json film_json(const Film& film, const std::vector<Title>& titles, std::size_t budget);

}  // namespace evodevo
