// STL files: triangles, each with its own copies of its corners, as text or in binary. Corners at the same place become
// one point.
#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <stdexcept>

#include "shape.hpp"

namespace evodevo {
namespace {

constexpr std::size_t head = 84, triangle_size = 50;  // bytes

float number_at(std::string_view bytes) {
  std::array<char, sizeof(float)> own;
  std::copy_n(bytes.data(), own.size(), own.begin());
  if constexpr (std::endian::native == std::endian::big) std::reverse(own.begin(), own.end());
  return std::bit_cast<float>(own);
}

std::size_t triangles_in(std::string_view content) {
  std::size_t count = 0;
  for (std::size_t byte = 4; byte-- > 0;) count = count << 8 | static_cast<unsigned char>(content[80 + byte]);
  return count;
}

/// Whether a file has as many triangles as it would promise as a binary file, which may begin like text.
bool is_whole_binary(std::string_view content) {
  return content.size() >= head && content.size() - head == triangles_in(content) * triangle_size;
}

class Triangles {
 public:
  void add(const std::array<std::array<double, 3>, 3>& corners) {
    std::array<std::int64_t, 3> triangle;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& [x, y, z] = corners[i];
      if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z))
        throw std::invalid_argument("triangle " + std::to_string(shape_.triangles.size() + 1) +
                                    ": a coordinate is not finite; expected finite numbers");
      const auto [found, is_new] = known_.emplace(corners[i], static_cast<std::int64_t>(shape_.points.size()));
      if (is_new) shape_.points.push_back({x, y, z});
      triangle[i] = found->second;
    }
    shape_.triangles.push_back(triangle);
  }

  Shape take() { return std::move(shape_); }

 private:
  Shape shape_;
  std::map<std::array<double, 3>, std::int64_t> known_;
};

Shape read_binary(std::string_view content) {
  const std::size_t promised = triangles_in(content), there = (content.size() - head) / triangle_size;
  if (promised != there)
    throw std::invalid_argument("its header promises " + std::to_string(promised) + " triangles, and " +
                                std::to_string(there) + " are there; expected a complete STL file");
  Triangles triangles;
  for (content.remove_prefix(head); content.size() >= triangle_size; content.remove_prefix(triangle_size)) {
    std::array<std::array<double, 3>, 3> corners;
    for (std::size_t i = 0; i < 9; ++i)  // after the normal
      corners[i / 3][i % 3] = number_at(content.substr(12 + i * sizeof(float)));
    triangles.add(corners);
  }
  return triangles.take();
}

Shape read_text(std::string_view content) {
  Triangles triangles;
  std::array<std::array<double, 3>, 3> corners;
  std::size_t count = 0;
  bool is_ended = false;
  for (std::size_t number = 1; !content.empty(); ++number) {
    std::string_view line = next_line(content);
    const std::string place = "line " + std::to_string(number) + ": ";
    const std::string_view what = next_word(line);
    if (what == "vertex") {
      if (count == 3) throw std::invalid_argument(place + "a facet with more than 3 vertices; expected triangles");
      for (double& coordinate : corners[count]) {
        const auto given = number_in<double>(next_word(line));
        if (!given) throw std::invalid_argument(place + "a vertex without three coordinates; expected numbers");
        coordinate = *given;
      }
      ++count;
    } else if (what == "endfacet") {
      if (count != 3)
        throw std::invalid_argument(place + "a facet with " + std::to_string(count) + " vertices; expected 3");
      triangles.add(corners);
      count = 0;
    }
    is_ended |= what == "endsolid";
  }
  if (!is_ended) throw std::invalid_argument("the file ends without endsolid; expected a complete STL file");
  return triangles.take();
}

}  // namespace

bool is_stl(std::string_view content) { return is_whole_binary(content) || next_word(content) == "solid"; }

Shape read_stl(std::string_view content) {
  const bool is_text =
      content.size() < head || (!is_whole_binary(content) && content.find("facet") != std::string_view::npos);
  Shape shape = is_text ? read_text(content) : read_binary(content);
  if (shape.triangles.empty()) throw std::invalid_argument("no triangles; expected an STL file with a surface");
  return shape;
}

}  // namespace evodevo
