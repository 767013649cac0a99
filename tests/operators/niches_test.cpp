// The helpers for descriptors: nearest neighbours, cells and novelty, compared with direct implementations.
#include "evodevo/helpers/selection/niches.hpp"

#include <numeric>

#include "evodevo/helpers/selection/novelty.hpp"
#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

std::vector<Coordinates> random_places(Rng& rng, std::size_t count, std::size_t dimension) {
  std::vector<Coordinates> places(count, Coordinates(dimension));
  for (Coordinates& place : places)
    for (double& coordinate : place) coordinate = rng.uniform();
  return places;
}

double distance(const Coordinates& a, const Coordinates& b) {
  double sum = 0;
  for (std::size_t axis = 0; axis < a.size(); ++axis) sum += (a[axis] - b[axis]) * (a[axis] - b[axis]);
  return std::sqrt(sum);
}

/// Returns the indices of all places, ordered by their distances to a place.
std::vector<std::uint32_t> by_distance(const std::vector<Coordinates>& places, const Coordinates& to) {
  std::vector<std::uint32_t> order(places.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](auto a, auto b) { return distance(places[a], to) < distance(places[b], to); });
  return order;
}

TEST(Neighbours, AreThoseOfAFullSearch) {
  for (const std::size_t dimension : {1, 2, 3, 7, 20})
    for (const std::size_t count : {1, 5, 30, 200}) {
      Rng rng = stream(dimension * 1000 + count);
      const auto places = random_places(rng, count, dimension);
      const Neighbours neighbours(places);
      for (const Coordinates& place : random_places(rng, 20, dimension)) {
        const auto order = by_distance(places, place);
        const auto found = neighbours.nearest(place, 12);
        ASSERT_EQ(found.size(), std::min<std::size_t>(12, count));
        for (std::size_t i = 0; i < found.size(); ++i) {
          EXPECT_EQ(found[i].index, order[i]) << "dimension " << dimension << ", places " << count;
          EXPECT_NEAR(found[i].distance, distance(places[order[i]], place), 1e-12);
        }
      }
    }
}

TEST(Neighbours, MayBeNoneOrLieAtOnePlace) {
  EXPECT_TRUE(Neighbours(std::vector<Coordinates>()).nearest(Coordinates{0.5}, 3).empty());
  EXPECT_TRUE(Neighbours(std::vector<Coordinates>{{0.5}}).nearest(Coordinates{0.5}, 0).empty());
  const auto copies = Neighbours(std::vector<Coordinates>(50, {0.25, 0.75})).nearest(Coordinates{0.25, 0.5}, 60);
  ASSERT_THAT(copies, ::testing::SizeIs(50));
  EXPECT_EQ(copies.back().distance, 0.25);
}

/// Returns descriptors with the range 0 to 2 and these numbers of bins.
std::vector<Objective> axes(const std::vector<std::uint32_t>& bins) {
  std::vector<Objective> axes;
  for (const std::uint32_t count : bins) axes.push_back({"x", "m", true, Role::descriptor, 0, 2, count});
  return axes;
}

TEST(GridCell, CountsTheLastAxisFastestAndTakesTheNearestCellOfWhatLiesOutside) {
  EXPECT_EQ(grid_cell(Coordinates{0.1, 1.9}, axes({10, 10})), 9u);
  EXPECT_EQ(grid_cell(Coordinates{1.9, 0.1}, axes({10, 10})), 90u);
  EXPECT_EQ(grid_cell(Coordinates{0.7, 0.5, 0.3}, axes({10, 10, 10})), 321u);
  EXPECT_EQ(grid_cell(Coordinates{0.7, 0.5, 0.3}, axes({3, 4, 7})), 1u * 28 + 1 * 7 + 1);
  for (const auto& [place, cell] : {std::pair{0.0, 0u}, {0.5, 1u}, {2.0, 3u}, {-1e300, 0u}, {1e300, 3u}})
    EXPECT_EQ(grid_cell(Coordinates{place}, axes({4})), cell) << place;
}

TEST(GridCell, MoreCellsThanNotesCanNumberAreRefused) {
  const Coordinates corner(17, 2.0);
  EXPECT_THAT([&] { grid_cell(corner, axes(std::vector<std::uint32_t>(17, 10))); },
              ::testing::ThrowsMessage<std::invalid_argument>(::testing::AllOf(
                  ::testing::HasSubstr("17"), ::testing::HasSubstr("bins"), ::testing::HasSubstr("centroidal"))));
  EXPECT_EQ(grid_cell(Coordinates(53, 2.0), axes(std::vector<std::uint32_t>(53, 2))), (std::uint64_t{1} << 53) - 1);
}

TEST(MoveCentroids, TakesTheMeanOfTheSamplesAround) {
  using ::testing::DoubleNear, ::testing::ElementsAre;
  std::vector<Coordinates> centroids{{0.2, 1}, {0.7, 1}, {5, 1}};
  EXPECT_NEAR(move_centroids(centroids, {{0.1, 1}, {0.2, 1}, {0.6, 1}, {0.9, 1}}), (0.01 + 0 + 0.01 + 0.04) / 4, 1e-12);
  EXPECT_THAT(centroids[0], ElementsAre(DoubleNear(0.15, 1e-12), 1));
  EXPECT_THAT(centroids[1], ElementsAre(DoubleNear(0.75, 1e-12), 1));
  EXPECT_THAT(centroids[2], ElementsAre(5, 1)) << "no sample is near it";
}

TEST(VoronoiCentres, HaveCellsOfSimilarSize) {
  for (const std::size_t dimension : {1, 2, 5}) {
    Rng rng = stream(dimension);
    const std::uint32_t count = 64;
    const Neighbours cells(voronoi_centres(count, dimension, rng));
    std::vector<double> size(count, 0);
    const int samples = 64000;
    for (const Coordinates& place : random_places(rng, samples, dimension))
      size[cells.nearest(place, 1)[0].index] += static_cast<double>(count) / samples;
    for (const double relative : size) {
      EXPECT_GT(relative, 0.4) << "dimension " << dimension;
      EXPECT_LT(relative, 2) << "dimension " << dimension;
    }
  }
}

/// The best tessellation of a line has equal cells.
TEST(VoronoiCentres, OfALineLieAtEqualDistances) {
  for (const std::uint32_t count : {1, 4}) {
    Rng rng = stream(1);
    auto centres = voronoi_centres(count, 1, rng);
    std::sort(centres.begin(), centres.end());
    ASSERT_EQ(centres.size(), count);
    for (std::uint32_t i = 0; i < count; ++i) EXPECT_NEAR(centres[i][0], (i + 0.5) / count, 0.02);
  }
}

std::vector<Behaviour> random_behaviours(Rng& rng, std::size_t count) {
  std::vector<Behaviour> behaviours;
  for (const Coordinates& place : random_places(rng, count, 2)) behaviours.push_back({place, 1.0 * rng.below(5)});
  return behaviours;
}

TEST(NoveltyOf, IndividualsIsThatOfAFullSearch) {
  for (const std::size_t archived : {0, 25}) {
    Rng rng = stream(archived);
    const auto rows = random_behaviours(rng, 30), archive = random_behaviours(rng, archived);
    const std::size_t k = 8;
    const auto found = novelty(rows, archive, k);
    ASSERT_EQ(found.size(), rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      std::vector<std::pair<double, double>> others;  // distance and score
      for (std::size_t j = 0; j < rows.size(); ++j)
        if (j != i) others.emplace_back(distance(rows[i].place, rows[j].place), rows[j].score);
      for (const Behaviour& one : archive) others.emplace_back(distance(rows[i].place, one.place), one.score);
      std::sort(others.begin(), others.end());
      double sum = 0;
      std::uint32_t beaten = 0;
      for (std::size_t j = 0; j < k; ++j) sum += others[j].first, beaten += others[j].second < rows[i].score;
      EXPECT_NEAR(found[i].distance, sum / static_cast<double>(k), 1e-12);
      EXPECT_EQ(found[i].beaten, beaten);
    }
  }
}

TEST(NoveltyOf, CopiesIsZeroAndThatOfTheAloneToo) {
  const std::vector<Behaviour> copies(30, {{0.5, 0.5}, 1}), alone{{{0.5, 0.5}, 1}};
  for (const Novelty& one : novelty(copies, {}, 5)) EXPECT_EQ(one.distance, 0);
  EXPECT_EQ(novelty(alone, {}, 5)[0].distance, 0);
  EXPECT_EQ(novelty(alone, std::vector<Behaviour>{{{0.5, 0}, 2}}, 5)[0].distance, 0.5);
  EXPECT_TRUE(novelty({}, {}, 5).empty());
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
