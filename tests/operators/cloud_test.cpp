// The encoding "cloud": masses in volumes and at points, and materials from the nearest site.
#include "cloud.hpp"

#include <functional>
#include <map>
#include <set>

#include "support/messages.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

using Cloud = FromFile;

double share(const std::vector<Vec3>& points, const std::function<bool(Vec3)>& is_in) {
  return static_cast<double>(std::count_if(points.begin(), points.end(), is_in)) / static_cast<double>(points.size());
}

// volumes ------------------------------------------------------------------------------------------------------------

/// The tolerances of shares are five standard deviations of a binomial distribution of 20,000 points.
constexpr double five_deviations = 5 * 0.5 / 141.4;

TEST_F(Cloud, IsUniformInASphere) {
  const auto points = places(sphere(12).obj(), "points = 20000");
  ASSERT_EQ(points.size(), 20000u);
  for (const Vec3& point : points) ASSERT_LE(norm(point), 1);
  // the faces are less than 2 % inside of the sphere, which makes the volume less than 6 % smaller
  EXPECT_NEAR(share(points, [](Vec3 p) { return norm(p) < 0.5; }), 0.125 * 1.02, 0.0125 * 0.3 + 5 * 0.0024);
  for (const auto axis : {&Vec3::x, &Vec3::y, &Vec3::z})
    EXPECT_NEAR(share(points, [&](Vec3 p) { return p.*axis > 0; }), 0.5, five_deviations);
}

TEST_F(Cloud, FillsAPolygonThatIsNotConvex) {
  // three cubes in an L; the longest side of the box is 2 m, so an edge is 1 m
  const Mesh mesh = prism({{0, 0}, {6, 0}, {6, 3}, {3, 3}, {3, 6}, {0, 6}}, 3);
  for (std::size_t turned = 0; turned < 6; ++turned) {  // so that each corner is the first one of its face
    Mesh other = mesh;
    for (auto& face : other.faces)
      std::rotate(face.begin(), face.begin() + static_cast<int>(turned % face.size()), face.end());
    const auto points = places(other.obj(), "points = 20000");
    const auto cube = [&](bool right, bool back) {
      return share(points, [&](Vec3 p) { return (p.x > 0) == right && (p.y > 0) == back; });
    };
    EXPECT_EQ(cube(true, true), 0) << "outside";
    for (const auto& [right, back] : {std::pair(false, false), {true, false}, {false, true}})
      EXPECT_NEAR(cube(right, back), 1.0 / 3, five_deviations);
    for (const Vec3& p : points) ASSERT_TRUE(std::abs(p.x) <= 1 && std::abs(p.y) <= 1 && std::abs(p.z) <= 0.5);
  }
}

TEST_F(Cloud, FillsPartsThatOverlapOnce) {
  const Mesh mesh = both(cuboid({0, 0, 0}, {2, 1, 1}), cuboid({1, 0, 0}, {3, 1, 1}));
  const auto points = places(mesh.obj(), "points = 20000\nside = 3.0");
  for (const double middle : {-1.0, 0.0, 1.0})
    EXPECT_NEAR(share(points, [&](Vec3 p) { return std::abs(p.x - middle) < 0.5; }), 1.0 / 3, five_deviations);
}

TEST_F(Cloud, LeavesHollowsEmpty) {
  Mesh hollow = cuboid({-1, -1, -1}, {1, 1, 1});
  for (auto& face : hollow.faces) std::reverse(face.begin(), face.end());
  const auto points = places(both(cuboid({-2, -2, -2}, {2, 2, 2}), hollow).obj(), "side = 4.0");
  for (const Vec3& p : points) EXPECT_GE(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}), 1);
}

TEST_F(Cloud, HasThePlacesOfTheSeedInAllBodies) {
  const std::string file = cuboid({0, 0, 0}, {1, 2, 3}).obj();
  EXPECT_EQ(places(file, "points_seed = 5", 1), places(file, "points_seed = 5", 2));
  EXPECT_NE(places(file, "points_seed = 5"), places(file, "points_seed = 6"));
  EXPECT_EQ(places(file, "points = 10")[9], places(file)[9]) << "fewer points are the first of more";
}

TEST_F(Cloud, DoesNotDependOnUnitsAndOrigin) {
  const auto points = places(cuboid({-1, -0.5, -0.25}, {1, 0.5, 0.25}).obj(), "side = 1.0");
  const auto others = places(cuboid({1e9, 1e9, 1e9}, {1e9 + 4096, 1e9 + 2048, 1e9 + 1024}).obj(), "side = 1.0");
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_NEAR(norm(points[i] - others[i]), 0, 1e-9);
  const auto first_in = [&](double edge) { return places(cuboid({0, 0, 0}, {edge, edge, edge}).obj())[0]; };
  EXPECT_NEAR(norm(first_in(1e200) - first_in(1)), 0, 1e-9);
}

// clouds -------------------------------------------------------------------------------------------------------------

TEST_F(Cloud, KeepsThePointsOfAFileWithoutFaces) {
  Mesh mesh = random_points(50);
  mesh.points[3] = {-8, -1, -1};
  mesh.points[7] = {8, 3, 1};  // the bounding box is (-8, -1, -1) to (8, 3, 1)
  for (const std::string& file : {mesh.obj(), mesh.ascii_ply(), mesh.binary_ply(false)}) {
    const Blueprint blueprint = body(file, "side = 4.0\nneighbours = 7");
    EXPECT_EQ(blueprint.neighbours, 7u);
    ASSERT_EQ(blueprint.body.masses.size(), 50u);
    ASSERT_EQ(blueprint.origins.size(), 50u);
    for (std::size_t i = 0; i < 50; ++i) {
      const Vec3 expected = 0.25 * (mesh.points[i] - Vec3{0, 1, 0});
      EXPECT_NEAR(norm(blueprint.body.masses[i].rest - expected), 0, 1e-12);
      EXPECT_NEAR(norm(blueprint.origins[i] - 0.5 * expected), 0, 1e-12);
    }
  }
}

TEST_F(Cloud, DrawsFromManyPointsWithoutReplacement) {
  const std::string file = random_points(500).obj();
  const auto all = places(file), some = places(file, "points = 100");
  std::set<std::ptrdiff_t> drawn;
  for (const Vec3& p : some) drawn.insert(std::ranges::find(all, p) - all.begin());
  EXPECT_EQ(some.size(), 100u);
  EXPECT_EQ(drawn.size(), 100u);
  EXPECT_FALSE(drawn.contains(500)) << "a place that is not in the file";
  EXPECT_NE(places(file, "points = 100\npoints_seed = 2"), some);
}

// sites --------------------------------------------------------------------------------------------------------------

TEST_F(Cloud, GivesEachMassTheMaterialOfTheNearestSite) {
  const auto encoding =
      cloud(cuboid({0, 0, 0}, {4, 2, 1}).obj(), "points = 500\nside = 8.0\nsites = 9\nmost_sites = 9");
  const Layout layout = encoding->layout(context());
  Rng rng = stream(3);
  std::set<std::int32_t> seen;
  for (int trial = 0; trial < 5; ++trial) {
    const Genome genome = encoding->random(layout, rng);
    ASSERT_EQ(genome.size(), 36u);
    for (const Mass& mass : decoded(*encoding, genome).body.masses) {
      std::map<double, std::int32_t> by_distance;
      for (std::size_t site = 0; site < 36; site += 4)  // the box is 8 m long, 4 m wide and 2 m high
        by_distance[norm(mass.rest - Vec3{4.0 * genome[site], 2.0 * genome[site + 1], 1.0 * genome[site + 2]})] =
            static_cast<std::int32_t>(genome[site + 3]);
      EXPECT_EQ(mass.material, by_distance.begin()->second);
      seen.insert(mass.material);
    }
  }
  EXPECT_EQ(seen.size(), 5u);
}

TEST_F(Cloud, OfTwoSitesAtOnePlaceTakesTheFirst) {
  const auto encoding = cloud(random_points(20).obj(), "sites = 2");
  Rng rng = stream(5);
  Genome genome = encoding->random(encoding->layout(context()), rng);
  std::copy_n(genome.data(), 3, genome.data() + 4);
  for (const float material : {0.0f, 1.0f}) {
    genome[3] = material;
    genome[7] = 1 - material;
    for (const Mass& mass : decoded(*encoding, genome).body.masses)
      EXPECT_EQ(mass.material, static_cast<std::int32_t>(material));
  }
}

TEST_F(Cloud, ChoosesAmongItsMaterials) {
  const std::string file = random_points(20).obj();
  std::set<std::int32_t> seen;
  for (std::uint64_t seed = 0; seed < 5; ++seed)
    for (const Mass& mass : body(file, "materials = ['muscle', 'tissue']", seed).body.masses)
      seen.insert(mass.material);
  EXPECT_THAT(seen, ::testing::ElementsAre(muscle, tissue));
  EXPECT_THAT(body(file, "materials = ['air']").failure, ::testing::HasSubstr("air"));
}

TEST_F(Cloud, LetsSitesComeAndGo) {
  const Layout layout = cloud(random_points(30).obj(), "sites = 3\nmost_sites = 5")->layout(context());
  EXPECT_EQ(layout.first_blocks.size(), 3u);
  const BlockType& site = layout.types.at(0);
  EXPECT_EQ(site.least, 1u);
  EXPECT_EQ(site.most, 5u);
  EXPECT_THAT(site.gene_names, ::testing::ElementsAre("x", "y", "z", "material"));
  EXPECT_EQ(site.option_names.at(3), context().material_names);
}

TEST_F(Cloud, RefusesMoreSitesThanMost) {
  EXPECT_THAT([&] { cloud(random_points(5).obj(), "sites = 9\nmost_sites = 8"); },
              ::testing::ThrowsMessage<ConfigError>(evodevo::testing::naming("sites", "9", "most_sites")));
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
