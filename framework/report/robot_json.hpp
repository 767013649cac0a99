// A robot as a page of the viewer holds it.
#pragma once

#include <nlohmann/json.hpp>

#include "report/filming.hpp"

namespace evodevo {

/// How far what the page shows may be from what was simulated, over all masses and filmed moments, m.
struct ViewError {
  double largest = 0;
  double most = 0;  ///< of 99 in 100
};

/// A film as JSON: its springs and masses numbered through the whole life, the shots with who is there, the springs'
/// materials and stress, and the places, of which so many frames are left out that all takes at most `budget` bytes.
/// What is there and the first and last frame of each shot are never left out, whatever they take.
/// `names` are those of the shots. A film without frames gives no shots.
///
///   masses      how many there ever are
///   ends        of each spring, two masses; packed like all that follows in numbers
///   step        unit of places, m
///   every       of the frames that were filmed, every so many-th is kept, and the last of a shot
///   error       ViewError of straight lines between the frames kept
///   shots       name, times (s), masses, springs (numbers of those present), materials, stress (of 255 parts of
///               the root of `most_stress`, N), places
nlohmann::ordered_json film_json(const Film& film, const std::vector<std::string>& names, std::size_t budget);

}  // namespace evodevo
