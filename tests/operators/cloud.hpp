// Meshes and clouds in the formats that the encoding "cloud" reads, for its tests.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <sstream>

#include "support.hpp"
#include "support/scratch.hpp"

namespace evodevo::test {

using Faces = std::vector<std::vector<int>>;

/// A mesh, and what each format makes of it. Indices of faces count from 0.
struct Mesh {
  std::vector<Vec3> points;
  Faces faces;

  std::string obj() const {
    std::ostringstream text;
    text.precision(17);
    for (const Vec3& p : points) text << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
    for (const auto& face : faces) {
      text << 'f';
      for (const int corner : face) text << ' ' << corner + 1;
      text << '\n';
    }
    return text.str();
  }

  std::string ply_header(const std::string& format) const {
    std::string text = "ply\nformat " + format + " 1.0\ncomment by hand\nelement vertex " +
                       std::to_string(points.size()) +
                       "\nproperty double x\nproperty double y\nproperty uchar red\nproperty double z\n";
    if (!faces.empty())
      text += "element face " + std::to_string(faces.size()) + "\nproperty list uchar int vertex_indices\n";
    return text + "end_header\n";
  }
  std::string ascii_ply() const {
    std::ostringstream text;
    text.precision(17);
    text << ply_header("ascii");
    for (const Vec3& p : points) text << p.x << ' ' << p.y << " 255 " << p.z << '\n';
    for (const auto& face : faces) {
      text << face.size();
      for (const int corner : face) text << ' ' << corner;
      text << '\n';
    }
    return text.str();
  }
  std::string binary_ply(bool big_endian) const {
    std::string text = ply_header(big_endian ? "binary_big_endian" : "binary_little_endian");
    const auto put = [&](auto number) {
      auto bytes = std::bit_cast<std::array<char, sizeof number>>(number);
      if (big_endian == (std::endian::native == std::endian::little)) std::reverse(bytes.begin(), bytes.end());
      text.append(bytes.data(), bytes.size());
    };
    for (const Vec3& p : points) put(p.x), put(p.y), put(std::uint8_t{255}), put(p.z);
    for (const auto& face : faces) {
      put(static_cast<std::uint8_t>(face.size()));
      for (const int corner : face) put(std::int32_t{corner});
    }
    return text;
  }

  /// Calls `use(a, b, c)` with the corners of each triangle.
  template <class Use>
  void for_each_triangle(const Use& use) const {
    const auto corner = [&](int i) { return points[static_cast<std::size_t>(i)]; };
    for (const auto& face : faces)
      for (std::size_t i = 2; i < face.size(); ++i) use(corner(face[0]), corner(face[i - 1]), corner(face[i]));
  }
  std::string ascii_stl() const {
    std::ostringstream text;
    text.precision(17);
    text << "solid by hand\n";
    for_each_triangle([&](const Vec3& a, const Vec3& b, const Vec3& c) {
      text << "  facet normal 0 0 0\n    outer loop\n";
      for (const Vec3& p : {a, b, c}) text << "      vertex " << p.x << ' ' << p.y << ' ' << p.z << '\n';
      text << "    endloop\n  endfacet\n";
    });
    text << "endsolid\n";
    return text.str();
  }
  std::string binary_stl(std::string text) const {
    text.resize(80, ' ');
    std::string triangles;
    std::uint32_t count = 0;
    const auto put = [](auto number, std::string& to) {
      auto bytes = std::bit_cast<std::array<char, sizeof number>>(number);
      if constexpr (std::endian::native == std::endian::big) std::reverse(bytes.begin(), bytes.end());
      to.append(bytes.data(), bytes.size());
    };
    for_each_triangle([&](const Vec3& a, const Vec3& b, const Vec3& c) {
      ++count;
      for (const Vec3& p : {Vec3{}, a, b, c})
        for (const double number : {p.x, p.y, p.z}) put(static_cast<float>(number), triangles);
      put(std::uint16_t{0}, triangles);
    });
    put(count, text);
    return text + triangles;
  }
};

/// The prism over a polygon whose corners are anticlockwise, from z = 0 to z = `height`.
inline Mesh prism(const std::vector<std::pair<double, double>>& corners, double height) {
  Mesh mesh;
  const int count = static_cast<int>(corners.size());
  for (const double z : {0.0, height})
    for (const auto& [x, y] : corners) mesh.points.push_back({x, y, z});
  mesh.faces.resize(2);
  for (int i = 0; i < count; ++i) {
    mesh.faces[0].push_back(count - 1 - i);
    mesh.faces[1].push_back(count + i);
    mesh.faces.push_back({i, (i + 1) % count, count + (i + 1) % count, count + i});
  }
  return mesh;
}

inline Mesh cuboid(Vec3 low, Vec3 high) {
  Mesh mesh = prism({{low.x, low.y}, {high.x, low.y}, {high.x, high.y}, {low.x, high.y}}, high.z - low.z);
  for (Vec3& point : mesh.points) point.z += low.z;
  return mesh;
}

inline Mesh both(Mesh one, const Mesh& other) {
  const int before = static_cast<int>(one.points.size());
  one.points.insert(one.points.end(), other.points.begin(), other.points.end());
  for (std::vector<int> face : other.faces) {
    for (int& corner : face) corner += before;
    one.faces.push_back(face);
  }
  return one;
}

/// A sphere of radius 1 and about 2 · `rings`² triangles and quadrilaterals.
inline Mesh sphere(int rings) {
  const double pi = 3.14159265358979323846;
  Mesh mesh{{{0, 0, -1}}, {}};
  const int around = 2 * rings;
  const auto at = [&](int ring, int i) { return 1 + (ring - 1) * around + i % around; };
  for (int ring = 1; ring < rings; ++ring)
    for (int i = 0; i < around; ++i) {
      const double latitude = pi * (static_cast<double>(ring) / rings - 0.5), longitude = 2 * pi * i / around;
      mesh.points.push_back(
          {std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude), std::sin(latitude)});
    }
  mesh.points.push_back({0, 0, 1});
  for (int i = 0; i < around; ++i) {
    mesh.faces.push_back({0, at(1, i + 1), at(1, i)});
    for (int ring = 1; ring + 1 < rings; ++ring)
      mesh.faces.push_back({at(ring, i), at(ring, i + 1), at(ring + 1, i + 1), at(ring + 1, i)});
    mesh.faces.push_back({at(rings - 1, i), at(rings - 1, i + 1), static_cast<int>(mesh.points.size()) - 1});
  }
  return mesh;
}

inline Mesh random_points(std::size_t count) {
  Mesh mesh;
  Rng rng = stream(6);
  for (std::size_t i = 0; i < count; ++i)
    mesh.points.push_back({rng.uniform(-4, 4), rng.uniform(), rng.uniform(-1, 1)});
  return mesh;
}

/// Makes encodings that read a file with a given content.
class FromFile : public ::testing::Test {
 protected:
  std::unique_ptr<Encoding> cloud(const std::string& content, const std::string& toml = "") {
    const std::string file = scratch_ / "shape";
    std::ofstream(file, std::ios::binary) << content;
    return make<Encoding>("cloud", "file = '" + file + "'\n" + toml);
  }
  Blueprint body(const std::string& content, const std::string& toml = "", std::uint64_t seed = 1) {
    const auto encoding = cloud(content, toml);
    Rng rng = stream(seed);
    return decoded(*encoding, encoding->random(encoding->layout(context()), rng));
  }
  std::vector<Vec3> places(const std::string& content, const std::string& toml = "", std::uint64_t seed = 1) {
    const Blueprint blueprint = body(content, toml, seed);
    EXPECT_EQ(blueprint.failure, "");
    std::vector<Vec3> places;
    for (const Mass& mass : blueprint.body.masses) places.push_back(mass.rest);
    return places;
  }
  /// Returns what prepare() throws, or nothing.
  std::string complaint(const std::string& content) {
    try {
      cloud(content);
      return "";
    } catch (const std::invalid_argument& error) {
      const std::string text = error.what();
      EXPECT_TRUE(text.starts_with((scratch_ / "shape").string() + ": ")) << text;
      return text;
    }
  }

  evodevo::testing::Scratch scratch_;
};

}  // namespace evodevo::test
