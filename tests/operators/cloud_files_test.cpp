// The files that the encoding "cloud" reads: formats, and what is said of broken files.
#include "cloud.hpp"
#include "support/messages.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

using CloudFile = FromFile;
using evodevo::testing::naming;

// formats ------------------------------------------------------------------------------------------------------------

TEST_F(CloudFile, IsTheSameFromAnyFormat) {
  const Mesh mesh = sphere(5);
  const auto expected = places(mesh.obj());
  EXPECT_EQ(places(mesh.ascii_ply()), expected);
  EXPECT_EQ(places(mesh.binary_ply(false)), expected);
  EXPECT_EQ(places(mesh.binary_ply(true)), expected);
}

TEST_F(CloudFile, FromStlFillsTheSameVolume) {
  const Mesh mesh = cuboid({0, 0, 0}, {1, 2, 4});
  const auto expected = places(mesh.obj());
  EXPECT_EQ(places(mesh.ascii_stl()), expected);
  EXPECT_EQ(places(mesh.binary_stl("")), expected);
  EXPECT_EQ(places(mesh.binary_stl("solid")), expected) << "some binary files begin like text";
  EXPECT_THAT(complaint("solid a\nfacet normal 0 0 1\nendsolid\n"), naming("no triangles", "STL"));
  EXPECT_THAT(complaint(mesh.ascii_stl().substr(0, mesh.ascii_stl().find("endsolid"))),
              naming("ends without endsolid"));
  EXPECT_THAT(complaint(mesh.binary_stl("solid").substr(0, 84 + 7 * 50)), naming("promises 12", "7 are there"));
  EXPECT_THAT(complaint("solid a\n facet\n vertex 0 0 0\n vertex 1 nan 0\n vertex 1 1 0\n endfacet\nendsolid\n"),
              naming("triangle 1", "not finite"));
  EXPECT_THAT(complaint("solid a\n facet\n vertex 0 0 0\n vertex 1 0 0\n endfacet\n"), naming("line 5", "2 vertices"));
  EXPECT_THAT(complaint("solid a\n facet\n vertex 0 0\n"), naming("line 3", "three coordinates"));
}

TEST_F(CloudFile, AByteOrderMarkChangesNothing) {
  const Mesh mesh = cuboid({0, 0, 0}, {1, 2, 4});
  for (const std::string& text : {mesh.obj(), mesh.ascii_ply(), mesh.ascii_stl()})
    EXPECT_EQ(places("\xef\xbb\xbf" + text), places(text));
}

TEST_F(CloudFile, StandsOnTheAxisThatPointsUp) {
  const Mesh mesh = cuboid({0, 0, 0}, {1, 2, 4});
  for (const auto& [up, height] : {std::pair{"x", 0.5}, {"y", 1.0}, {"z", 2.0}}) {
    Vec3 low{9, 9, 9}, high{-9, -9, -9};
    for (const Vec3& p : places(mesh.obj(), "up = '" + std::string(up) + "'")) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    EXPECT_NEAR(high.z - low.z, height, 0.05 * height) << up;
    EXPECT_NEAR((high.x - low.x) * (high.y - low.y) * (high.z - low.z), 1, 0.1) << up;
  }
}

TEST_F(CloudFile, ReadsWhatObjFilesMayHave) {
  const std::string plain = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  const std::string rich =
      "# a tetrahedron\r\nmtllib none.mtl\r\no body\r\n  v +0 0.0 0e0 1.0\r\nv\t1 0 0 0.5 0.5 0.5\r\nv 0 1 0\r\n"
      "v 0 0 1\r\nvn 0 0 1\r\nvt 0 0\r\nusemtl red\r\ns off\r\nf 1/1/1 3//1 2\r\nf -4 -3 -1 # a comment\r\nf 2/1 3/1 "
      "4/1\r\n"
      "f 3 1 4";
  EXPECT_EQ(places(rich), places(plain));
}

TEST_F(CloudFile, ReadsWhatPlyFilesMayHave) {
  // elements and properties that are no part of a shape, old and new names of types, and a header with CR LF
  const std::string head =
      "ply\r\nformat ascii 1.0\r\nobj_info none\r\nelement camera 2\r\nproperty list uint8 float32 view\r\n"
      "property int id\r\nelement vertex 4\r\nproperty float x\r\nproperty float32 y\r\nproperty float z\r\n"
      "element none 99999999999\r\nelement face 4\r\nproperty uchar red\r\nproperty list uint8 uint vertex_index\r\n"
      "end_header\r\n";
  const std::string text =
      head + "3 .1 .2 .3 7\n0 8\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n9 3 0 2 1\n9 3 0 1 3\n9 3 1 2 3\n9 3 2 0 3\n";
  EXPECT_EQ(places(text), places("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"));
}

// broken files -------------------------------------------------------------------------------------------------------

TEST(CloudWithoutFile, SaysWhatToSet) {
  EXPECT_THAT([] { make<Encoding>("cloud"); },
              ::testing::ThrowsMessage<ConfigError>(naming("test.file", "PLY, OBJ or STL file")));
}

TEST_F(CloudFile, NamesPlaceAndRemedyOfABrokenObjFile) {
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_THAT(complaint(""), naming("no vertices", "PLY, OBJ or STL"));
  EXPECT_THAT(complaint(std::string("\x89PNG\r\n\x1a\n\0\0f 7", 13)), naming("binary", "PLY, OBJ or STL"));
  EXPECT_THAT(complaint("v 0 0 0\nv 1 nan 0\n"), naming("vertex 2", "not finite"));
  EXPECT_THAT(complaint("v 0 0 0\nv 1 1e999 0\n"), naming("line 2", "three coordinates"));
  EXPECT_THAT(complaint("v 0 0 0\n\nv 1 0\n"), naming("line 3", "three coordinates"));
  EXPECT_THAT(complaint("v 0 0 0\nv one 0 0\n"), naming("line 2", "three coordinates"));
  EXPECT_THAT(complaint(corners + "f 1 2 4\n"), naming("vertex 4", "1 to 3"));
  EXPECT_THAT(complaint(corners + "f 1 2 -4\n"), naming("vertex 0", "1 to 3"));
  EXPECT_THAT(complaint(corners + "f 1 2 9223372036854775807\n"), naming("vertex 9223372036854775807", "1 to 3"));
  EXPECT_THAT(complaint(corners + "f 1 2 99999999999999999999\n"), naming("line 4", "whole number"));
  EXPECT_THAT(complaint(corners + "f 1 2 0\n"), naming("line 4", "other than 0"));
  EXPECT_THAT(complaint(corners + "f 1 2 a\n"), naming("line 4", "whole number"));
  EXPECT_THAT(complaint(corners + "f 1 2\n"), naming("line 4", "2 corners", "at least 3"));
  EXPECT_THAT(complaint("v 2 2 2\nv 2 2 2\n"), naming("bounding box", "different places"));
  EXPECT_THAT(complaint("v -1e308 0 0\nv 1e308 0 0\n"), naming("bounding box", "inf", "different places"));
  EXPECT_THAT(complaint("v 0 0 0\nv 1e-320 0 0\n"), naming("bounding box", "different places"));
}

TEST_F(CloudFile, NamesASurfaceThatEnclosesNoVolume) {
  EXPECT_THAT(complaint("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n"), naming("open", "3 edges", "closed surface"));
  Mesh inwards = cuboid({0, 0, 0}, {1, 1, 1});
  for (auto& face : inwards.faces) std::reverse(face.begin(), face.end());
  EXPECT_THAT(complaint(inwards.obj()), naming("inside out", "anticlockwise"));
  EXPECT_THAT(complaint("v 0 0 0\nv 1 1 1\nv 1e-4 0 0\nv 0 1e-4 0\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"),
              naming("encloses", "0.5 %"));
}

TEST_F(CloudFile, NamesPlaceAndRemedyOfABrokenPlyFile) {
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n", begin = "ply\nformat ascii 1.0\n";
  const std::string two = begin + "element vertex 2\n" + xyz;
  const std::string face = "element face 1\nproperty list char int vertex_indices\nend_header\n";
  EXPECT_THAT(complaint("ply\n"), naming("end_header"));
  EXPECT_THAT(complaint("ply\nend_header\n"), naming("format"));
  EXPECT_THAT(complaint("ply\nformat utf8 1.0\nend_header\n"), naming("format utf8", "binary_little_endian"));
  EXPECT_THAT(complaint(begin + "end_header\n"), naming("no vertices"));
  EXPECT_THAT(complaint(begin + "element vertex -1\n" + xyz + "end_header\n"),
              naming("element vertex -1", "whole number"));
  EXPECT_THAT(complaint(begin + "element vertex 99999999999999999999\n"),
              naming("99999999999999999999", "whole number"));
  EXPECT_THAT(complaint(begin + "property float x\n"), naming("property float x", "after an element"));
  EXPECT_THAT(complaint(begin + "element vertex 1\nproperty half x\n"), naming("property half x", "known types"));
  EXPECT_THAT(complaint(begin + "element vertex 1\nproperty list half float x\n"), naming("known types"));
  EXPECT_THAT(complaint(begin + "element vertex 1\nproperty float x\nproperty float z\nend_header\n0 0"),
              naming("vertex", "property y"));
  EXPECT_THAT(complaint(two + "end_header\n0 0 0\n1 1"), naming("vertex", "item 2 of 2", "ends here"));
  EXPECT_THAT(complaint(two + "end_header\n0 0 0\n1 x 1"), naming("vertex", "item 2 of 2", "no number"));
  EXPECT_THAT(complaint(two + "end_header\n0 0 0\n1 nan 1"), naming("vertex 2", "not finite"));
  EXPECT_THAT(complaint(two + "element face 1\nproperty float x\nend_header\n"), naming("face", "vertex_indices"));
  EXPECT_THAT(complaint(two + face + "0 0 0 1 1 1\n3 0 1 2"), naming("vertex 3", "1 to 2"));
  EXPECT_THAT(complaint(two + face + "0 0 0 1 1 1\n3 0 1 -1"), naming("face", "item 1 of 1", "index"));
  EXPECT_THAT(complaint(two + face + "0 0 0 1 1 1\n3 0 1 0.5"), naming("face", "item 1 of 1", "index"));
  EXPECT_THAT(complaint(two + face + "0 0 0 1 1 1\n2 0 1"), naming("face", "2 corners", "at least 3"));
  EXPECT_THAT(complaint(two + face + "0 0 0 1 1 1\n-3 0 1 1"), naming("face", "list"));
  EXPECT_THAT(complaint(two + face + "0 0 0 1 1 1\nnan 0 1 1"), naming("face", "list"));
}

TEST_F(CloudFile, ReservesNothingForWhatAHeaderPromises) {
  // more than any memory holds
  const std::string count =
      "element vertex 18446744073709551615\nproperty double x\nproperty double y\nproperty double z\n";
  for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"})
    EXPECT_THAT(complaint("ply\nformat " + format + " 1.0\n" + count + "end_header\n"),
                naming("item 1 of 18446744073709551615", "ends here"));
  EXPECT_THAT(complaint("ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list uint int vertex_index\n"
                        "end_header\n\xff\xff\xff\xff"),
              naming("face", "ends here"));
}

TEST_F(CloudFile, BearsAnyCutAndAnyChangedByte) {
  const Mesh mesh = cuboid({0, 0, 0}, {1, 1, 1});
  for (const std::string& whole :
       {mesh.obj(), mesh.ascii_ply(), mesh.binary_ply(false), mesh.ascii_stl(), mesh.binary_stl("")}) {
    ASSERT_EQ(complaint(whole), "");
    for (std::size_t length = 0; length < whole.size(); length += std::max<std::size_t>(5, whole.size() / 100))
      complaint(whole.substr(0, length));
    Rng rng = stream(9);
    for (int i = 0; i < 150; ++i) {
      std::string other = whole;
      other[rng.below(static_cast<std::uint32_t>(other.size()))] = static_cast<char>(rng.below(256));
      complaint(other);
    }
  }
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
