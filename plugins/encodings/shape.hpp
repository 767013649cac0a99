// Shapes that are read from files: surfaces of triangles, and clouds of points.
//
// Files may come with a run that somebody else recorded, so they are read by code that bears any of them. The libraries
// at hand do not: of 3,000 small files that were damaged at random, OpenMesh 9.0 crashed or did not end in 463, and it
// read 465 as another shape without a word; Assimp 5.2.5 has known overflows, and tinyobjloader 2.0rc10 reads words
// that are no numbers as 0.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "evodevo/parameters.hpp"

namespace evodevo {

/// A surface, or a cloud of points if there are no triangles. Triangles are anticlockwise as seen from outside, and
/// hold the indices of their points.
struct Shape {
  std::vector<Vec3> points;
  std::vector<std::array<std::int64_t, 3>> triangles;
  Vec3 half;  ///< half of the sides of the bounding box; set by read_shape()

  /// Adds the triangles of a polygon, all of which have its first corner. Where the polygon is not convex, some of them
  /// overlap, but solid angles as in winding_number() remain those of the polygon, since they have signs. Throws
  /// std::invalid_argument if there are fewer than three corners.
  void add_polygon(const std::vector<std::int64_t>& corners);
};

/// Reads a PLY or STL file, or an OBJ file if the content begins like neither. The axis of the file that points up,
/// "x", "y" or "z", becomes z. The bounding box of the result, in which a surface's points without triangles do not
/// count, is centred on the origin, and its longest side is 2. Throws std::invalid_argument with the name of the file,
/// the place in it, and what is expected.
Shape read_shape(const InputFile& file, std::string_view up);

/// Returns how many times the surface winds around a point (generalised winding number: Jacobson et al. 2013): 1 inside
/// of a closed surface, 2 inside of two that overlap, 0 outside. Takes time in proportion to the number of points and
/// triangles.
double winding_number(const Shape& shape, Vec3 point);

/// Reads the vertices and faces of a PLY file (Turk 1994), whose indices may be out of range. Throws
/// std::invalid_argument with the place in the file and what is expected.
Shape read_ply(std::string_view content);

/// Whether a file is an STL file, as text or in binary.
bool is_stl(std::string_view content);
/// Reads the triangles of an STL file. Throws like read_ply().
Shape read_stl(std::string_view content);

/// What keeps a surface from enclosing a volume: that it is inside out or open, or an empty text.
std::string surface_fault(const Shape& shape);

/// Removes the first line of a text and returns it without its line end.
inline std::string_view next_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

/// Removes the first word of a text, with the spaces before it, and returns it. It is empty if there is none.
inline std::string_view next_word(std::string_view& text) {
  constexpr std::string_view spaces = " \t\r\n\v\f";
  text.remove_prefix(std::min(text.find_first_not_of(spaces), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(spaces));
  text.remove_prefix(word.size());
  return word;
}

/// Returns the number that a word is, or nothing if it is none that Number can hold.
template <class Number>
std::optional<Number> number_in(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  Number number{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return number;
}

}  // namespace evodevo
