// The encoding "regulatory": embryos grow from one cell by regulatory genes.
#include <cmath>
#include <set>

#include "life/body_building.hpp"
#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

using ::testing::SizeIs;

// the products of cells that remember two numbers and have two materials, and then their surroundings, in the order of
// the encoding
enum : int { divide, to_x, to_y, to_z, adhesion, signal_, memory_1, of_bone, of_muscle };
enum : int { neighbours = of_muscle + 1, room, time_gone, x, y, z };

/// A gene that makes `product` by tanh(weight * input + weight_b * input_b + bias).
struct TestGene {
  int product;
  float bias;
  int input = divide;
  float weight = 0;
  int input_b = divide;
  float weight_b = 0;
};

class Regulatory : public ::testing::Test {
 protected:
  /// Returns what an encoding with two steps makes of genes.
  static Blueprint embryo(const std::vector<TestGene>& genes, const std::string& toml = "steps = 2") {
    const auto encoding = make<Encoding>("regulatory", toml + "\nspacing = 0.1\nmaterials = ['bone', 'muscle']");
    const Layout layout = encoding->layout(context());
    Genome genome(0);
    for (const TestGene& gene : genes) {
      const auto number = [](int value) { return static_cast<float>(value); };
      for (const float value :
           {number(gene.product), number(gene.input), gene.weight, number(gene.input_b), gene.weight_b, gene.bias})
        genome.genes.push_back(value);
    }
    return encoding->decode(genome, layout, context());
  }

  static std::vector<Vec3> places(const Blueprint& blueprint) {
    std::vector<Vec3> places;
    for (const Mass& mass : blueprint.body.masses) places.push_back((std::sqrt(2.0) / 0.1) * mass.rest);
    return places;
  }

  static std::set<std::pair<int, int>> joined(const Blueprint& blueprint) {
    std::set<std::pair<int, int>> pairs;
    for (const Spring& spring : blueprint.body.springs) pairs.insert({spring.a, spring.b});
    return pairs;
  }
};

TEST_F(Regulatory, ACellThatDoesNotDivideIsNoBody) {
  const Blueprint blueprint = embryo({{to_x, 3}});
  EXPECT_THAT(blueprint.body.masses, SizeIs(1));
  EXPECT_EQ(build_body(blueprint).failure, "no springs");
}

TEST_F(Regulatory, CellsDivideWhereTheirProductsPoint) {
  const Blueprint up = embryo({{divide, 1}, {to_z, 3}, {to_x, 1}}, "steps = 1");
  ASSERT_THAT(up.body.masses, SizeIs(2));
  EXPECT_NEAR(norm(places(up)[1] - Vec3{1, 0, 1}), 0, 1e-12);
  const Blueprint back = embryo({{divide, 1}, {to_y, 3}, {to_x, -1}}, "steps = 1");
  EXPECT_NEAR(norm(places(back)[1] - Vec3{-1, 1, 0}), 0, 1e-12);
}

TEST_F(Regulatory, EveryCellDividesInAStepUntilThereAreEnough) {
  EXPECT_THAT(embryo({{divide, 1}, {to_z, 1}}, "steps = 3\ncells = 5").body.masses, SizeIs(5));
  const Blueprint many = embryo({{divide, 1}, {to_z, 1}}, "steps = 20\ncells = 300");
  ASSERT_THAT(many.body.masses, SizeIs(300));
  EXPECT_EQ(many.origins, std::vector<Vec3>(300)) << "they come from the place of the first";
  for (std::size_t a = 0; a < 300; ++a)
    for (std::size_t b = 0; b < a; ++b)
      ASSERT_GE(norm(many.body.masses[a].rest - many.body.masses[b].rest), 0.1 - 1e-12) << a << ' ' << b;
}

TEST_F(Regulatory, CellsBesideEachOtherAreJoinedOnce) {
  const Blueprint blueprint = embryo({{divide, 1}, {to_z, 1}}, "steps = 3");
  const std::vector<Mass>& masses = blueprint.body.masses;
  ASSERT_THAT(masses, SizeIs(8));
  std::set<std::pair<int, int>> near;
  for (int a = 0; a < 8; ++a)
    for (int b = a + 1; b < 8; ++b)
      if (norm(masses[a].rest - masses[b].rest) < 0.101) near.insert({a, b});
  EXPECT_EQ(joined(blueprint), near);
  EXPECT_THAT(blueprint.body.springs, SizeIs(near.size()));
  for (const Spring& spring : blueprint.body.springs) EXPECT_DOUBLE_EQ(spring.rest_length, 0.1);
  EXPECT_GT(near.size(), 8u);
}

TEST_F(Regulatory, CellsOfDifferentAdhesionSortOut) {
  const auto with = [&](std::vector<TestGene> genes) {
    genes.insert(genes.begin(), {{divide, 1}, {to_z, 1}});
    return embryo(genes, "steps = 6\ncells = 40");
  };
  // tanh(6 tanh(x/4) - 0.75) is -0.63 at x = 0, 0.62 at x = 1 and 0.97 at x = 2
  const TestGene by_place{adhesion, -0.375F, x, 3};
  const Blueprint alike = with({}), mixed = with({by_place, by_place, by_place, by_place});
  ASSERT_EQ(places(alike), places(mixed));
  std::size_t apart = 0;
  for (const auto& [a, b] : joined(alike)) {
    const auto [low, high] = std::minmax({std::lround(places(alike)[a].x), std::lround(places(alike)[b].x)});
    const bool sorts_out = low == 0 && high == 1;
    EXPECT_EQ(joined(mixed).contains({a, b}), !sorts_out) << a << ' ' << b;
    apart += sorts_out;
  }
  EXPECT_GT(apart, 0u);
}

TEST_F(Regulatory, CellsHaveTheMaterialOfWhichTheyMakeMost) {
  // 3 tanh(z/4) - 0.9 is below 0 at z = 1 and above at z = 2
  const Blueprint blueprint = embryo({{divide, 1}, {to_z, 3}, {to_x, 1}, {of_muscle, -0.9F, z, 3}}, "steps = 3");
  ASSERT_THAT(blueprint.body.masses, SizeIs(8));
  std::size_t muscles = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    const bool is_muscle = places(blueprint)[i].z > 1.5;
    EXPECT_EQ(blueprint.body.masses[i].material, is_muscle ? muscle : bone) << i;
    muscles += is_muscle;
  }
  EXPECT_TRUE(muscles > 0 && muscles < 8) << muscles;
}

TEST_F(Regulatory, CellsRememberTheirSignalsAndMemories) {
  const Blueprint blueprint = embryo({{divide, 1}, {signal_, 0.5F}, {memory_1, 0, neighbours, 2}});
  ASSERT_THAT(blueprint.mass_memory, SizeIs(2));
  const double signal = std::tanh(0.5);  // of all cells
  for (const double value : blueprint.mass_memory.at("signal")) EXPECT_DOUBLE_EQ(value, signal);
  for (const double value : blueprint.mass_memory.at("memory 1")) EXPECT_NEAR(value, std::tanh(2 * signal), 1e-12);
  EXPECT_THAT(blueprint.mass_memory.at("memory 1"), SizeIs(4));
  EXPECT_THAT(embryo({{divide, 1}}, "memory = 5").mass_memory, SizeIs(5));
}

TEST_F(Regulatory, GenesOfOneProductAddUpAndEachHasTwoInputs) {
  const Blueprint three = embryo({{divide, 1}, {signal_, 0.5F}, {signal_, 0.25F}, {signal_, 0, time_gone, 2}});
  for (const double value : three.mass_memory.at("signal"))
    EXPECT_NEAR(value, std::tanh((0.75 + 2) / std::sqrt(3.0)), 1e-12);
  const Blueprint one = embryo({{divide, 1}, {signal_, 0.125F, room, 0.25F, time_gone, 0.5F}}, "steps = 1");
  EXPECT_THAT(one.mass_memory.at("signal"), SizeIs(2));  // each has the other one beside it, and eleven free sites
  for (const double value : one.mass_memory.at("signal"))
    EXPECT_NEAR(value, std::tanh(0.25 * 11 / 12 + 0.5 + 0.125), 1e-12);
}

TEST_F(Regulatory, GenomesHaveRoomForAsManyGenesAsAsked) {
  const auto most = [](const std::string& toml) {
    return make<Encoding>("regulatory", toml)->layout(context()).types.at(0).most;
  };
  EXPECT_EQ(most(""), 128u);
  EXPECT_EQ(most("genes = 7\nmost_genes = 7"), 7u);
  EXPECT_THAT([&] { most("genes = 8\nmost_genes = 7"); },
              ::testing::ThrowsMessage<InputError>(::testing::HasSubstr("most_genes")));
}

TEST_F(Regulatory, RandomGenomesOftenGiveBodiesWithMusclesWhoseMassesDiffer) {
  const auto encoding = make<Encoding>("regulatory", "materials = ['bone', 'muscle', 'muscle2', 'tissue']");
  const Layout layout = encoding->layout(context());
  Rng rng = stream(1);
  int bodies = 0, with_muscles = 0, that_differ = 0;
  for (int i = 0; i < 200; ++i) {
    const BuiltBody built = build_body(encoding->decode(encoding->random(layout, rng), layout, context()));
    const auto moves = [&](const Spring& spring) { return built.body.materials[spring.material].amplitude > 0; };
    with_muscles += std::ranges::any_of(built.body.springs, moves);
    if (!built.failure.empty()) continue;
    ++bodies;
    const auto [least, most] = std::ranges::minmax(built.mass_memory.at("signal"));
    that_differ += most - least > 0.1;
  }
  EXPECT_GT(bodies, 100);
  EXPECT_GT(with_muscles, 60);
  EXPECT_GT(that_differ, 60);
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
