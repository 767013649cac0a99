#include <cmath>
#include <map>
#include <set>

#include "base/genome_sections.hpp"
#include "evodevo/neat.hpp"
#include "support.hpp"
#include "support/messages.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// Returns all values of a blueprint without springs in one list, for comparisons.
std::vector<double> digest(const Blueprint& blueprint) {
  std::vector<double> digest{static_cast<double>(blueprint.neighbours)};
  for (const Mass& m : blueprint.body.masses)
    digest.insert(digest.end(), {m.rest.x, m.rest.y, m.rest.z, m.mass, static_cast<double>(m.material)});
  for (const auto& [name, numbers] : blueprint.mass_memory) digest.insert(digest.end(), numbers.begin(), numbers.end());
  return digest;
}

/// Returns a random body of an encoding with parameters.
Blueprint random_body(const char* name, const std::string& toml, Rng& rng) {
  const auto encoding = make<Encoding>(name, toml);
  return decoded(*encoding, encoding->random(encoding->layout(context()), rng));
}

class AnyEncoding : public ::testing::TestWithParam<const char*> {};

TEST_P(AnyEncoding, MakesBodiesOfTheMassOfTheWorldButNoneOfAirAlone) {
  Rng rng = stream(2);
  for (int i = 0; i < 5; ++i) {
    const Blueprint blueprint = random_body(GetParam(), "", rng);
    EXPECT_EQ(blueprint.failure, "");
    EXPECT_THAT(blueprint.body.masses, ::testing::Each(::testing::Field(&Mass::mass, 0.2)));
  }
  EXPECT_THAT(random_body(GetParam(), "materials = ['air']", rng).failure, ::testing::HasSubstr("air"));
}

INSTANTIATE_TEST_SUITE_P(Encodings, AnyEncoding, ::testing::Values("neural", "cppn", "neat", "voxel", "direct"));

// neural -------------------------------------------------------------------------------------------------------------

TEST(Neural, HasThePapersGenes) {
  const Layout layout = make<Encoding>("neural")->layout(context());
  // genes: 25 neurons with 1 + 3, 25 with 1 + 25, and 3 + 5 with 1 + 25
  ASSERT_EQ(layout.first_size(), 958u);
  ASSERT_EQ(layout.first_blocks.size(), 58u);
  for (std::size_t n = 0; n < 58; ++n) EXPECT_EQ(layout.first_blocks[n].count, n < 25 ? 4u : 26u);
  ASSERT_EQ(layout.types.size(), 1u);
  EXPECT_THAT(layout.types[0].genes, ::testing::ElementsAre(GeneSpec{-1, 1}));
}

TEST(Neural, OneOutputForEachMaterialToChooseFrom) {
  const char* materials = "materials = ['tissue', 'bone']";
  EXPECT_EQ(make<Encoding>("neural", materials)->layout(context()).first_size(), 958u - 3 * 26);
  std::set<std::int32_t> seen;
  Rng rng = stream(1);
  for (int i = 0; i < 20; ++i)
    for (const Mass& mass : random_body("neural", materials, rng).body.masses) seen.insert(mass.material);
  EXPECT_THAT(seen, ::testing::ElementsAre(bone, tissue));
}

/// Returns the points at which the encoding evaluates its network. The weights make the network output its input: its
/// six hidden neurons compute x = relu(x) - relu(-x).
std::vector<Vec3> points_of(const std::string& toml) {
  const auto encoding = make<Encoding>("neural", "hidden = 6\n" + toml);
  const Layout layout = encoding->layout(context());
  Genome genome(layout.first_size(), 0);
  const auto weight = [&](std::size_t neuron, std::size_t input) -> float& {
    return genome[layout.first_blocks[neuron].first + 1 + input];
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    weight(2 * axis, axis) = 1;
    weight(2 * axis + 1, axis) = -1;
    weight(6 + 2 * axis, 2 * axis) = weight(6 + 2 * axis + 1, 2 * axis + 1) = 1;
    weight(12 + axis, 2 * axis) = 1;
    weight(12 + axis, 2 * axis + 1) = -1;
  }
  std::vector<Vec3> points;
  for (const Mass& mass : decoded(*encoding, genome).body.masses)
    points.push_back({std::atanh(mass.rest.x), std::atanh(mass.rest.y), std::atanh(mass.rest.z)});
  return points;
}

TEST(Neural, PointsAreUniformInTheBall) {
  const auto points = points_of("points = 20000");
  ASSERT_EQ(points.size(), 20000u);
  Vec3 mean;
  std::size_t inner = 0;
  for (const Vec3& point : points) {
    EXPECT_LE(norm(point), 1 + 1e-9);
    mean = mean + (1.0 / 20000) * point;
    inner += norm(point) < 0.5;
  }
  // the inner ball has an eighth of the volume; the tolerance is five standard deviations
  EXPECT_NEAR(static_cast<double>(inner) / 20000, 1.0 / 8, 0.012);
  EXPECT_LT(norm(mean), 0.02);
}

TEST(Neural, PointsDependOnTheirSeedAlone) {
  EXPECT_NE(points_of("points_seed = 5"), points_of("points_seed = 6"));
  // a shorter list is the beginning of a longer one
  EXPECT_EQ(points_of("points = 100")[99], points_of("")[99]);
}

/// Computes the outputs of the paper's network for one point directly.
std::vector<double> network(const Genome& genome, const Layout& layout, Vec3 point) {
  std::vector<double> values{point.x, point.y, point.z};
  std::size_t group = 0;
  for (const std::size_t last : {25u, 50u, static_cast<unsigned>(layout.first_blocks.size())}) {
    std::vector<double> next;
    for (; group < last; ++group) {
      const float* gene = &genome[layout.first_blocks[group].first];
      double sum = gene[0];
      for (std::size_t i = 0; i < values.size(); ++i) sum += gene[1 + i] * values[i];
      next.push_back(last <= 50 ? std::max(0.0, sum) : sum);
    }
    values = next;
  }
  return values;
}

TEST(Neural, IsThePapersNetworkWithTwoMoreOutputsForSizes) {
  const auto encoding = make<Encoding>("neural", "side = 3.0\nneighbours = 7\nsize_range = 0.25");
  const Layout layout = encoding->layout(context());
  const auto points = points_of("");
  Rng rng = stream(4);
  for (int trial = 0; trial < 3; ++trial) {
    const Genome genome = encoding->random(layout, rng);
    const Blueprint blueprint = decoded(*encoding, genome);
    EXPECT_EQ(blueprint.neighbours, 7u);
    ASSERT_EQ(blueprint.body.masses.size(), points.size());
    ASSERT_EQ(blueprint.mass_memory.size(), 2u);
    const std::vector<double>&births = blueprint.mass_memory.at("size at birth"),
          &ends = blueprint.mass_memory.at("size at the end");
    ASSERT_EQ(births.size(), points.size());
    ASSERT_EQ(ends.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto outputs = network(genome, layout, points[i]);
      ASSERT_EQ(outputs.size(), 3u + 5 + 2);
      const Mass& mass = blueprint.body.masses[i];
      EXPECT_NEAR(mass.rest.x, 1.5 * std::tanh(outputs[0]), 1e-9);
      EXPECT_NEAR(mass.rest.y, 1.5 * std::tanh(outputs[1]), 1e-9);
      EXPECT_NEAR(mass.rest.z, 1.5 * std::tanh(outputs[2]), 1e-9);
      const double greatest = *std::max_element(outputs.begin() + 3, outputs.begin() + 8);
      EXPECT_NEAR(outputs[3 + static_cast<std::size_t>(mass.material)], greatest, 1e-9);
      EXPECT_NEAR(births[i], 1 + 0.25 * std::tanh(outputs[8]), 1e-9);
      EXPECT_NEAR(ends[i], 1 + 0.25 * std::tanh(outputs[9]), 1e-9);
    }
  }
}

TEST(Neural, GenesThatAreNoNumbersAreNoBody) {
  const auto encoding = make<Encoding>("neural");
  for (const float value : {std::nanf(""), std::numeric_limits<float>::infinity()}) {
    Genome genome(958, 0.5f);
    genome[500] = value;
    EXPECT_THAT(decoded(*encoding, genome).failure, evodevo::testing::naming("gene", "not finite"));
  }
}

class AnyNetwork : public ::testing::TestWithParam<const char*> {};

TEST_P(AnyNetwork, PairsBeforeTheMappingAreThoseOfThePoints) {
  const auto after = make<Encoding>(GetParam()), before = make<Encoding>(GetParam(), "pairing = 'before-mapping'");
  const Layout layout = after->layout(context());
  Rng rng = stream(8);
  const Genome genome = after->random(layout, rng), other = after->random(layout, rng);
  Blueprint mapped = decoded(*after, genome), paired = decoded(*before, genome);
  EXPECT_TRUE(mapped.paired_at.empty());
  EXPECT_EQ(mapped.neighbours, 25u);
  ASSERT_EQ(paired.paired_at.size(), 1000u);
  const auto points = points_of("");
  for (std::size_t i = 0; i < 1000; ++i) EXPECT_NEAR(norm(paired.paired_at[i] - points[i]), 0, 1e-9);
  EXPECT_EQ(paired.paired_at, decoded(*before, other).paired_at) << "the points are those of the run";
  EXPECT_EQ(mapped.origins, paired.paired_at);
  paired.paired_at.clear();
  EXPECT_EQ(digest(paired), digest(mapped)) << "all else is the same";
}

TEST_P(AnyNetwork, SizesAreTwoMoreNeuronsThatChangeNothingElse) {
  for (const std::string pairing : {"pairing = 'after-mapping'", "pairing = 'before-mapping'"}) {
    const auto fixed = make<Encoding>(GetParam(), pairing);
    const auto sized = make<Encoding>(GetParam(), pairing + "\nsize_range = 0.9");
    EXPECT_THAT(fixed->spring_memory(), ::testing::IsEmpty());
    EXPECT_THAT(sized->spring_memory(), ::testing::ElementsAre("growth"));
    const Layout less = fixed->layout(context()), more = sized->layout(context());
    ASSERT_EQ(more.first_blocks.size(), less.first_blocks.size() + 2);
    EXPECT_EQ(more.first_size(), less.first_size() + 2 * less.first_blocks.back().count);
    EXPECT_EQ(layout_fault(more), "");

    Rng rng = stream(10);
    const Genome genome = sized->random(more, rng);
    Blueprint blueprint = decoded(*sized, genome);
    ASSERT_EQ(blueprint.mass_memory.at("size at the end").size(), 1000u);
    blueprint.mass_memory.clear();
    Genome without = genome;
    without.genes.resize(less.first_size());
    EXPECT_EQ(digest(blueprint), digest(decoded(*fixed, without)));
  }
}

TEST_P(AnyNetwork, PlacesAndSizesStayInTheirRangesWhateverTheGenes) {
  const auto encoding = make<Encoding>(GetParam(), "size_range = 0.5\npoints = 20");
  const Layout layout = encoding->layout(context());
  for (const float value : {-1.0f, 0.0f, 1.0f, 1e30f}) {
    Genome genome(layout.first_size(), value);
    for (std::size_t i = 0; i < genome.size(); ++i)
      if (layout.gene(genome, i).is_choice()) genome[i] = 0;
    const Blueprint blueprint = decoded(*encoding, genome);
    for (const Mass& mass : blueprint.body.masses)
      for (const double position : {mass.rest.x, mass.rest.y, mass.rest.z}) EXPECT_LE(std::abs(position), 1);
    ASSERT_EQ(blueprint.mass_memory.size(), 2u);
    for (const auto& [name, sizes] : blueprint.mass_memory)
      EXPECT_THAT(sizes, ::testing::AllOf(::testing::SizeIs(20),
                                          ::testing::Each(::testing::AllOf(::testing::Ge(0.5), ::testing::Le(1.5)))))
          << name;
  }
}

TEST_P(AnyNetwork, SpringsToNeighboursHaveTheMeanSizeOfTheirMassesAndGrowToThatAtTheEnd) {
  Blueprint blueprint;
  blueprint.body.masses.resize(3);
  blueprint.body.springs = {{0, 1, 1, 0}, {2, 1, 2, 0}, {0, 2, 3, 0}};
  const std::vector<double> births = {1.5, 0.5, 0.75}, ends = {0.5, 1.0, 1.25};
  blueprint.mass_memory = {{"size at birth", births}, {"size at the end", ends}};
  const Blueprint before = blueprint;
  make<Encoding>(GetParam())->joined(blueprint);
  EXPECT_TRUE(blueprint.spring_memory.empty()) << "without sizes";
  EXPECT_EQ(blueprint.body.springs[2].rest_length, 3);
  make<Encoding>(GetParam(), "size_range = 0.5")->joined(blueprint);
  ASSERT_EQ(blueprint.spring_memory.size(), 1u);
  const std::vector<double>& growth = blueprint.spring_memory.at("growth");
  ASSERT_EQ(growth.size(), 3u);
  for (std::size_t s = 0; s < 3; ++s) {
    const auto& [a, b, distance, material, first_length, factor] = before.body.springs[s];
    const double length = blueprint.body.springs[s].rest_length;
    EXPECT_DOUBLE_EQ(length, distance * (births[a] + births[b]) / 2);
    EXPECT_NEAR(length * (1 + growth[s]), distance * (ends[a] + ends[b]) / 2, 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(Networks, AnyNetwork, ::testing::Values("neural", "cppn"));

// options ------------------------------------------------------------------------------------------------------------

/// Returns the names of the options of each choice gene of a layout, by the type of its block and its position.
std::map<std::pair<std::string, std::size_t>, std::vector<std::string>> options_of(const Layout& layout) {
  std::map<std::pair<std::string, std::size_t>, std::vector<std::string>> options;
  for (const BlockType& type : layout.types)
    for (std::size_t gene = 0; gene < type.genes.size(); ++gene)
      if (const auto names = type.options(gene); type.genes[gene].is_choice())
        options[{type.name, gene}] = {names.begin(), names.end()};
  return options;
}

TEST(Options, HaveNames) {
  const auto of = [](const std::string& name, const std::string& toml = "") {
    const Layout layout = make<Encoding>(name, toml)->layout(context());
    EXPECT_EQ(layout_fault(layout), "") << name;
    return options_of(layout);
  };
  using ::testing::Pair;
  using ::testing::UnorderedElementsAre;
  const std::vector<std::string> materials = context().material_names, some = {"bone", "tissue"},
                                 functions = {"linear", "tanh", "sine", "gaussian", "absolute"};
  const std::string chosen = "materials = [\"tissue\", \"bone\"]\n";
  EXPECT_THAT(of("cppn"), UnorderedElementsAre(Pair(Pair("neuron", 0), functions)));
  EXPECT_THAT(of("cppn", "hidden = 4"), UnorderedElementsAre(Pair(Pair("neuron", 0), functions)))
      << "both layers have neurons of one type";
  EXPECT_THAT(of("neat"), UnorderedElementsAre(Pair(Pair("node", neat::function), functions),
                                               Pair(Pair("link", neat::on), std::vector<std::string>{"off", "on"})));
  EXPECT_THAT(of("direct"), UnorderedElementsAre(Pair(Pair("springs", 0), materials)));
  EXPECT_THAT(of("direct", chosen), UnorderedElementsAre(Pair(Pair("springs", 0), some)));
  EXPECT_THAT(of("voxel", chosen), UnorderedElementsAre(Pair(Pair("voxel", 0), some)));
  EXPECT_THAT(of("voxel", "size_range = 0.5\nphase_range = 0.5\nmirrored = \"body\""),
              UnorderedElementsAre(Pair(Pair("voxel", 2), materials)));
  std::vector<std::string> products = {"divide", "to x", "to y", "to z", "adhesion", "signal", "memory 1"},
                           inputs = {"signal beside", "free sites", "time", "x", "y", "z"};
  for (const std::string& material : some) products.push_back("material " + material);
  inputs.insert(inputs.begin(), products.begin(), products.end());
  EXPECT_THAT(of("regulatory", chosen + "memory = 2"),
              UnorderedElementsAre(Pair(Pair("gene", 0), products), Pair(Pair("gene", 1), inputs),
                                   Pair(Pair("gene", 3), inputs)));
}

// cppn ---------------------------------------------------------------------------------------------------------------

TEST(Cppn, EveryHiddenNeuronHasAFunctionOfItsOwn) {
  const Layout layout = make<Encoding>("cppn", "hidden = 6")->layout(context());
  ASSERT_EQ(layout.first_blocks.size(), 6u + 6 + 8);
  for (std::size_t n = 0; n < 20; ++n) {
    EXPECT_EQ(layout.first_blocks[n].count, n < 6 ? 6u : n < 12 ? 8u : 7u);
    for (std::uint32_t g = 0; g < layout.first_blocks[n].count; ++g)
      EXPECT_EQ(layout.gene({}, layout.first_blocks[n].first + g).choices, n < 12 && g == 0 ? 5u : 0u);
  }
}

TEST(Cppn, FunctionsAreStanleys) {
  // the first neuron of each hidden layer and the first output pass on the value, so the output is the function of x
  const auto encoding = make<Encoding>("cppn", "hidden = 2\npoints = 50");
  const Layout layout = encoding->layout(context());
  const std::vector<Vec3> points = points_of("points = 50");
  const std::vector<double (*)(double)> functions = {
      [](double x) { return x; }, [](double x) { return std::tanh(x); }, [](double x) { return std::sin(x); },
      [](double x) { return std::exp(-x * x); }, [](double x) { return std::fabs(x); }};
  for (std::size_t f = 0; f < functions.size(); ++f) {
    Genome genome(layout.first_size(), 0);
    const auto gene = [&](std::size_t neuron, std::size_t index) -> float& {
      return genome[layout.first_blocks[neuron].first + index];
    };
    gene(0, 0) = static_cast<float>(f);
    gene(0, 1) = 0.5f;  // bias
    gene(0, 2) = 2;     // weight of x
    gene(0, 5) = -1;    // weight of the distance from the centre
    gene(2, 2) = 1;
    gene(4, 1) = 1;
    const Body body = decoded(*encoding, genome).body;
    for (std::size_t i = 0; i < 50; ++i)
      EXPECT_NEAR(body.masses[i].rest.x, std::tanh(functions[f](0.5 + 2 * points[i].x - norm(points[i]))), 1e-9);
  }
}

// lattices -----------------------------------------------------------------------------------------------------------

/// Returns the body that an encoding with parameters makes of genes.
Body body_of(const Genome& genome, const std::string& toml, const char* name = "voxel") {
  return decoded(*make<Encoding>(name, toml), genome).body;
}

/// Returns the number of springs of each stiffness.
std::map<double, int> stiffnesses(const Body& body) {
  std::map<double, int> count;
  for (const Spring& spring : body.springs) ++count[body.materials[spring.material].stiffness];
  return count;
}

TEST(Voxel, OneVoxelIsACubeOfTwentyEightSprings) {
  const Layout layout = make<Encoding>("voxel", "size = [1, 1, 1]")->layout(context());
  ASSERT_EQ(layout.first_size(), 1u);
  EXPECT_EQ(layout.gene({}, 0).choices, 5u);
  const Body body = body_of({muscle}, "size = [1, 1, 1]\nedge = 0.5");
  ASSERT_EQ(body.masses.size(), 8u);
  for (const Mass& mass : body.masses) {
    for (const double position : {mass.rest.x, mass.rest.y, mass.rest.z}) EXPECT_DOUBLE_EQ(std::abs(position), 0.25);
    EXPECT_EQ(mass.material, no_material);
    EXPECT_EQ(mass.air_contacts, 0u);
  }
  std::map<long, int> lengths;  // keys in tenths of a millimetre
  for (const Spring& spring : body.springs) {
    ++lengths[std::lround(spring.rest_length * 1e4)];
    EXPECT_DOUBLE_EQ(spring.rest_length, norm(body.masses[spring.a].rest - body.masses[spring.b].rest));
    EXPECT_EQ(spring.material, static_cast<std::uint32_t>(muscle));
  }
  EXPECT_EQ(lengths, (std::map<long, int>{{5000, 12}, {7071, 12}, {8660, 4}}));
}

TEST(Voxel, SharedSpringsTakeTheMean) {
  const Body body = body_of({muscle2, bone}, "size = [2, 1, 1]");
  EXPECT_EQ(body.masses.size(), 12u);
  // the six springs of the shared face belong to both voxels
  EXPECT_EQ(stiffnesses(body), (std::map<double, int>{{5000, 22}, {7500, 6}, {10000, 22}}));
  for (const Spring& spring : body.springs) {
    const Material& material = body.materials[spring.material];
    if (material.stiffness != 7500) continue;
    EXPECT_EQ(material, mean(context().materials[muscle2], context().materials[bone]));
    EXPECT_EQ(body.masses[spring.a].rest.x, 0);
    EXPECT_EQ(body.masses[spring.b].rest.x, 0);
  }
}

TEST(Voxel, SpringsOfTheirOwnActInParallel) {
  const char* own = "size = [2, 1, 1]\nsprings = 'own'";
  const Body body = body_of({muscle2, bone}, own);
  EXPECT_EQ(stiffnesses(body), (std::map<double, int>{{5000, 28}, {10000, 28}}));
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> joins;
  for (const Spring& spring : body.springs) ++joins[std::minmax(spring.a, spring.b)];
  EXPECT_EQ(std::ranges::count_if(joins, [](const auto& join) { return join.second == 2; }), 6) << "the common face";
  for (const Mass& mass : body.masses) EXPECT_DOUBLE_EQ(mass.mass, context().mass * (mass.rest.x == 0 ? 2 : 1) / 8);
  const Body alone = body_of({muscle2, air}, own);
  EXPECT_EQ(stiffnesses(alone), (std::map<double, int>{{5000, 28}}));
  for (const Spring& spring : alone.springs)
    for (const std::uint32_t end : {spring.a, spring.b}) EXPECT_DOUBLE_EQ(alone.masses[end].mass, context().mass / 8);
}

TEST(Voxel, VoxelsOfAirAreAbsent) {
  const Body body = body_of({muscle, air}, "size = [2, 1, 1]");
  EXPECT_EQ(stiffnesses(body), (std::map<double, int>{{5000, 28}}));
  for (const Mass& mass : body.masses) {
    // a corner that belongs only to the air voxel has 7 contacts; a corner of the shared face has 4, with the corners
    // of the opposite face
    const unsigned expected = mass.rest.x < -0.05 ? 0 : mass.rest.x < 0.05 ? 4 : 7;
    EXPECT_EQ(mass.air_contacts, expected);
  }
  EXPECT_TRUE(body_of({air, air}, "size = [2, 1, 1]").springs.empty());
}

TEST(Voxel, UniformBodiesNeedNoNewMaterial) {
  for (const std::int32_t material : {bone, muscle, muscle2, tissue})
    EXPECT_EQ(body_of(Genome(27, static_cast<float>(material)), "size = [3, 3, 3]").materials.size(), 5u);
}

TEST(Voxel, OptionsAreTheChosenMaterials) {
  const char* toml = "size = [2, 1, 1]\nmaterials = ['air', 'tissue', 'bone']";
  EXPECT_EQ(make<Encoding>("voxel", toml)->layout(context()).gene({}, 1).choices, 3u);
  // options are in the order of the world's materials: air, bone, tissue
  EXPECT_EQ(stiffnesses(body_of({1, 2}, toml)), (std::map<double, int>{{4000, 22}, {7000, 6}, {10000, 22}}));
}

TEST(Voxel, SizesAreGenesOnlyWhereTheyDevelop) {
  EXPECT_EQ(make<Encoding>("voxel", "size = [2, 1, 1]")->layout(context()).first_size(), 2u);
  const Layout layout = make<Encoding>("voxel", "size = [2, 1, 1]\nsize_range = 0.25")->layout(context());
  ASSERT_EQ(layout.first_size(), 6u);
  ASSERT_EQ(layout.first_blocks.size(), 2u);
  EXPECT_EQ(layout.gene({}, 3).choices, 5u);
  for (const std::size_t gene : {1, 2, 4, 5}) {
    EXPECT_EQ(layout.gene({}, gene).low, 0.75f);
    EXPECT_EQ(layout.gene({}, gene).high, 1.25f);
  }
}

TEST(Voxel, SpringsTakeTheSizesAndThePhasesOfTheirVoxels) {
  // the last voxel is air, whose phases and sizes have no effect
  const Genome genome{0.25f, -0.5f, muscle2, 0.5f, 1.5f, 0.5f, 1.0f, muscle2,
                      1.0f,  0.75f, 0.75f,   0.0f, air,  1.5f, 1.5f};
  const auto encoding = make<Encoding>("voxel", "size = [3, 1, 1]\nedge = 0.5\nphase_range = 1.0\nsize_range = 0.5");
  EXPECT_THAT(encoding->spring_memory(), ::testing::ElementsAre("growth", "turn"));
  const Blueprint blueprint = decoded(*encoding, genome);
  const Body& body = blueprint.body;
  ASSERT_EQ(body.springs.size(), 50u);
  ASSERT_EQ(blueprint.spring_memory.at("growth").size(), 50u);
  ASSERT_EQ(blueprint.spring_memory.at("turn").size(), 50u);
  const double pi = 3.14159265358979323846;
  for (std::size_t s = 0; s < 50; ++s) {
    const Spring& spring = body.springs[s];
    const double growth = blueprint.spring_memory.at("growth")[s], turn = blueprint.spring_memory.at("turn")[s];
    const Vec3 a = body.masses[spring.a].rest, b = body.masses[spring.b].rest;
    const double x = (a.x + b.x) / 2 + 0.75;
    const double start = x < 0.49 ? 0.5 : x < 0.51 ? 0.75 : 1, end = x < 0.49 ? 1.5 : x < 0.51 ? 1.125 : 0.75;
    EXPECT_NEAR(spring.rest_length, start * norm(b - a), 1e-12);
    EXPECT_NEAR(spring.rest_length * (1 + growth), end * norm(b - a), 1e-6);
    const double birth = x < 0.49 ? 0.25 : x < 0.51 ? 0.375 : 0.5, last = x < 0.49 ? -0.5 : x < 0.51 ? 0.25 : 1;
    EXPECT_NEAR(body.materials[spring.material].phase, pi + 2 * pi * birth, 1e-9) << "muscle2 has the phase pi";
    EXPECT_NEAR(turn, 2 * pi * (last - birth), 1e-5) << "in turns";
  }
}

TEST(Voxel, WithoutGrowthThereIsOneGeneForEachSizeAndPhase) {
  const auto encoding = make<Encoding>("voxel", "size = [1, 1, 1]\nsize_range = 0.5\nphase_range = 1.0\ngrows = false");
  const Layout layout = encoding->layout(context());
  EXPECT_EQ(layout.first_size(), 3u);
  EXPECT_THAT(layout.types[0].gene_names, ::testing::ElementsAre("phase at birth", "material", "size at birth"));
  EXPECT_THAT(encoding->spring_memory(), ::testing::IsEmpty());
  const Blueprint blueprint = decoded(*encoding, {0.25f, muscle, 1.5f});
  EXPECT_EQ(blueprint.body.springs.size(), 28u);
  EXPECT_TRUE(blueprint.spring_memory.empty());
}

TEST(Voxel, PassiveSpringsHaveNoPhase) {
  const auto encoding = make<Encoding>("voxel", "size = [1, 1, 1]\nphase_range = 1.0");
  EXPECT_THAT(encoding->spring_memory(), ::testing::ElementsAre("turn"));
  const Blueprint blueprint = decoded(*encoding, {0.25f, 1.0f, bone});
  EXPECT_EQ(blueprint.body.materials.size(), context().materials.size());
  ASSERT_EQ(blueprint.spring_memory.size(), 1u);
  EXPECT_EQ(blueprint.spring_memory.at("turn"), std::vector(blueprint.body.springs.size(), 0.0));
}

/// How many properties of a body's springs differ from those of their mirror images: of material and size, of phases.
std::pair<int, int> asymmetries(const Blueprint& blueprint) {
  const Body& body = blueprint.body;
  const auto ends_of = [&](const Spring& spring, double side) {
    std::set<std::vector<long>> ends;
    for (const std::uint32_t end : {spring.a, spring.b}) {
      const Vec3 rest = 1e4 * body.masses[end].rest;
      ends.insert({std::lround(side * rest.x), std::lround(rest.y), std::lround(rest.z)});
    }
    return ends;
  };
  std::map<std::set<std::vector<long>>, std::size_t> by_ends;
  for (std::size_t s = 0; s < body.springs.size(); ++s) by_ends[ends_of(body.springs[s], 1)] = s;
  const auto remembered = [&](const char* name, std::size_t spring) {
    const auto found = blueprint.spring_memory.find(name);
    return found == blueprint.spring_memory.end() ? 0 : found->second.at(spring);
  };
  const auto differ = [](double a, double b) { return std::abs(a - b) > 1e-5; };
  std::pair<int, int> differences{0, 0};
  for (std::size_t s = 0; s < body.springs.size(); ++s) {
    const std::size_t mirrored = by_ends.at(ends_of(body.springs[s], -1));
    const Spring &one = body.springs[s], &image = body.springs[mirrored];
    const auto differ_by = [&](const char* name) { return differ(remembered(name, s), remembered(name, mirrored)); };
    const Material &own = body.materials[one.material], &other = body.materials[image.material];
    differences.first += differ(own.stiffness, other.stiffness) + differ(own.amplitude, other.amplitude) +
                         differ(one.rest_length, image.rest_length) + differ_by("growth");
    differences.second += differ(own.phase, other.phase) + differ_by("turn");
  }
  return differences;
}

TEST(Voxel, MirroredGenesMakeSymmetricBodies) {
  Rng rng = stream(6);
  const auto body = [&](const std::string& mirrored) {
    const char* toml =
        "size = [5, 2, 2]\nmaterials = ['bone', 'muscle', 'tissue']\nsize_range = 0.5\nphase_range = 1.0\nmirrored = ";
    return random_body("voxel", toml + ("'" + mirrored + "'"), rng);
  };
  for (int i = 0; i < 3; ++i) {
    EXPECT_GT(asymmetries(body("nothing")).first, 0);
    const auto [of_bodies, of_phases] = asymmetries(body("body"));
    EXPECT_EQ(of_bodies, 0);
    EXPECT_GT(of_phases, 0) << "phases are not mirrored";
    EXPECT_EQ(asymmetries(body("all")), (std::pair{0, 0}));
  }
}

TEST(Voxel, MirroredGenesExistOnce) {
  const auto genes = [](const std::string& mirrored) {
    const std::string toml = "size = [4, 4, 3]\nsize_range = 0.5\nphase_range = 1.0\nmirrored = '" + mirrored + "'";
    return make<Encoding>("voxel", toml)->layout(context()).first_size();
  };
  EXPECT_EQ(genes("nothing"), 48u * 5);
  EXPECT_EQ(genes("body"), 48u * 2 + 24 * 3);
  EXPECT_EQ(genes("all"), 24u * 5);
}

TEST(Direct, MirroredSpringsShareAGene) {
  const char* mirrored = "size = [3, 2, 1]\nmirrored = true";
  const Layout layout = make<Encoding>("direct", mirrored)->layout(context());
  EXPECT_EQ(layout_fault(layout), "");
  const std::size_t all = make<Encoding>("direct", "size = [3, 2, 1]")->layout(context()).first_size();
  EXPECT_GT(layout.first_size(), all / 2) << "springs that are their own image have a gene, too";
  EXPECT_LT(layout.first_size(), 2 * all / 3);
  Rng rng = stream(8);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(asymmetries(random_body("direct", mirrored, rng)), (std::pair{0, 0}));
}

TEST(Direct, EverySpringHasAGene) {
  const Layout one = make<Encoding>("direct", "size = [1, 1, 1]")->layout(context());
  EXPECT_EQ(one.first_size(), 28u);
  std::vector<std::uint32_t> counts;
  for (const Block& group : one.first_blocks) counts.push_back(group.count);
  EXPECT_THAT(counts, ::testing::ElementsAre(7, 6, 5, 4, 3, 2, 1));
  EXPECT_EQ(make<Encoding>("direct", "size = [2, 1, 1]")->layout(context()).first_size(), 50u);
  // the body of the paper's benchmark, section V-A
  EXPECT_EQ(make<Encoding>("direct", "size = [10, 10, 10]")->layout(context()).first_size(), 14230u);
}

TEST(Direct, GenesStandInTheOrderOfTheSprings) {
  Genome genome(28, tissue);
  genome[0] = bone;      // masses 0 and 1
  genome[6] = muscle;    // masses 0 and 7
  genome[27] = muscle2;  // masses 6 and 7
  genome[7] = air;       // masses 1 and 2
  const Body body = body_of(genome, "size = [1, 1, 1]", "direct");
  ASSERT_EQ(body.springs.size(), 27u);
  for (const Spring& spring : body.springs) {
    const std::pair<std::uint32_t, std::uint32_t> ends = std::minmax(spring.a, spring.b);
    std::uint32_t expected = tissue;
    if (ends == std::pair{0u, 1u}) expected = bone;
    if (ends == std::pair{0u, 7u}) expected = muscle;
    if (ends == std::pair{6u, 7u}) expected = muscle2;
    EXPECT_EQ(spring.material, expected) << spring.a << " " << spring.b;
    EXPECT_NE(ends, (std::pair{1u, 2u}));
  }
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(body.masses[i].air_contacts, i == 1 || i == 2 ? 1u : 0u);
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
