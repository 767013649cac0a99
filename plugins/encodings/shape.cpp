#include "shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

namespace evodevo {
namespace {

constexpr std::string_view what_is_read = "expected a PLY, OBJ or STL file with vertices";

/// Returns the index of a point from 0. OBJ counts from 1, or back from the latest vertex if the index is negative.
std::int64_t read_corner(std::string_view word, std::size_t points) {
  const auto index = number_in<std::int64_t>(word.substr(0, word.find('/')));
  if (!index || *index == 0) throw std::invalid_argument("no index of a vertex; expected a whole number other than 0");
  return *index > 0 ? *index - 1 : *index + static_cast<std::int64_t>(points);
}

void read_obj_line(std::string_view line, Shape& shape) {
  const std::string_view what = next_word(line);
  if (what == "v") {
    std::array<double, 3> place;
    for (double& coordinate : place) {
      const auto number = number_in<double>(next_word(line));
      if (!number) throw std::invalid_argument("a vertex without three coordinates; expected numbers");
      coordinate = *number;
    }
    shape.points.push_back({place[0], place[1], place[2]});
  } else if (what == "f") {
    std::vector<std::int64_t> corners;
    for (std::string_view word = next_word(line); !word.empty() && word[0] != '#'; word = next_word(line))
      corners.push_back(read_corner(word, shape.points.size()));
    shape.add_polygon(corners);
  }
}

/// Reads the vertices and faces of an OBJ file. Other lines are ignored, whatever they are.
Shape read_obj(std::string_view content) {
  Shape shape;
  for (std::size_t line = 1; !content.empty(); ++line) {
    try {
      read_obj_line(next_line(content), shape);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("line " + std::to_string(line) + ": " + error.what());
    }
  }
  return shape;
}

using Vec3Key = std::array<double, 3>;

bool is_finite(Vec3 p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

void check(const Shape& shape) {
  if (shape.points.empty()) throw std::invalid_argument("no vertices; " + std::string(what_is_read));
  for (std::size_t i = 0; i < shape.points.size(); ++i)
    if (!is_finite(shape.points[i]))
      throw std::invalid_argument("vertex " + std::to_string(i + 1) +
                                  ": a coordinate is not finite; expected finite numbers");
  const auto count = static_cast<std::int64_t>(shape.points.size());
  for (const auto& triangle : shape.triangles)
    for (const std::int64_t corner : triangle)
      if (corner < 0 || corner >= count)
        throw std::invalid_argument("a face names vertex " + std::to_string(corner + 1) +
                                    ", counted from 1; expected 1 to " + std::to_string(count));
}

Box bounding_box(const Shape& shape) {
  const double infinity = std::numeric_limits<double>::infinity();
  Box box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  const auto include = [&box](Vec3 p) {
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
  };
  for (const auto& triangle : shape.triangles)
    for (const std::int64_t corner : triangle) include(shape.points[static_cast<std::size_t>(corner)]);
  if (shape.triangles.empty())
    for (const Vec3& point : shape.points) include(point);
  return box;
}

/// Turns the shape so that an axis becomes z. The handedness stays, so that no surface is turned inside out.
void turn_up(std::string_view axis, Shape& shape) {
  for (Vec3& p : shape.points) p = axis == "x" ? Vec3{p.y, p.z, p.x} : axis == "y" ? Vec3{p.z, p.x, p.y} : p;
}

void centre_and_scale(Shape& shape) {
  const Box box = bounding_box(shape);
  const double longest = box.longest_side();
  if (!(longest > 0) || !std::isfinite(longest) || !std::isfinite(2 / longest))
    throw std::invalid_argument("the longest side of the bounding box is " + std::to_string(longest) +
                                "; expected vertices at different places");
  const Vec3 centre = 0.5 * box.low + 0.5 * box.high;
  const double scale = 2 / longest;
  for (Vec3& point : shape.points) point = scale * (point - centre);
  shape.half = scale * (0.5 * box.high - 0.5 * box.low);
}

}  // namespace

void Shape::add_polygon(const std::vector<std::int64_t>& corners) {
  if (corners.size() < 3)
    throw std::invalid_argument("a face with " + std::to_string(corners.size()) + " corners; expected at least 3");
  for (std::size_t i = 2; i < corners.size(); ++i) triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

Shape read_shape(const InputFile& file, std::string_view up) {
  try {
    std::string_view content = file.content;
    if (content.starts_with("\xef\xbb\xbf")) content.remove_prefix(3);  // the byte order mark of UTF-8
    const bool is_ply = content.starts_with("ply\n") || content.starts_with("ply\r\n");
    if (!is_ply && !is_stl(content) && content.find('\0') != std::string_view::npos)
      throw std::invalid_argument("is binary, but neither PLY nor STL; " + std::string(what_is_read));
    Shape shape = is_ply ? read_ply(content) : is_stl(content) ? read_stl(content) : read_obj(content);
    check(shape);
    turn_up(up, shape);
    centre_and_scale(shape);
    return shape;
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(file.path + ": " + error.what());
  }
}

std::string surface_fault(const Shape& shape) {
  std::map<std::pair<Vec3Key, Vec3Key>, int> edges;
  double volume = 0;
  const auto key = [&](std::int64_t i) {
    const Vec3& p = shape.points[static_cast<std::size_t>(i)];
    return Vec3Key{p.x, p.y, p.z};
  };
  for (const auto& [i, j, k] : shape.triangles) {
    const Vec3 &a = shape.points[static_cast<std::size_t>(i)], &b = shape.points[static_cast<std::size_t>(j)],
               &c = shape.points[static_cast<std::size_t>(k)];
    volume += dot(a, cross(b, c)) / 6;
    for (const auto& [from, to] : {std::pair{i, j}, {j, k}, {k, i}}) {
      ++edges[{key(from), key(to)}];
      --edges[{key(to), key(from)}];
    }
  }
  const auto open = std::ranges::count_if(edges, [](const auto& edge) { return edge.second == 1; });
  if (std::ranges::any_of(edges, [](const auto& edge) { return edge.second > 1; }))
    return "has neighbouring faces that are anticlockwise as seen from different sides";
  if (open > 0) return "is open: it ends at " + std::to_string(open) + " edges";
  return volume < 0 ? "is inside out: its faces are clockwise as seen from outside" : "";
}

double winding_number(const Shape& shape, Vec3 point) {
  struct Corner {
    Vec3 from_point;
    double distance;
  };
  std::vector<Corner> corners;
  corners.reserve(shape.points.size());
  for (const Vec3& p : shape.points) corners.push_back({p - point, norm(p - point)});
  double half_angles = 0;
  for (const auto& triangle : shape.triangles) {
    const auto& [a, length_a] = corners[static_cast<std::size_t>(triangle[0])];
    const auto& [b, length_b] = corners[static_cast<std::size_t>(triangle[1])];
    const auto& [c, length_c] = corners[static_cast<std::size_t>(triangle[2])];
    const Vec3 normal = cross(b, c);
    // half of the triangle's solid angle (Van Oosterom and Strackee 1983)
    half_angles += std::atan2(dot(a, normal), length_a * length_b * length_c + dot(a, b) * length_c +
                                                  dot(b, c) * length_a + dot(c, a) * length_b);
  }
  return half_angles / (2 * 3.14159265358979323846);
}

}  // namespace evodevo
