// Materials as springs' codes say them: near what they are, the same on the way to the GPU and on the CPU.
#include "computed_materials.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support.hpp"

namespace evodevo::test {
namespace {

/// Materials of all kinds of numbers, muscles and others.
std::vector<Material> random_materials(std::size_t count) {
  const Body places = random_body(static_cast<std::uint32_t>(count), 1, 1, 3);  // coordinates in [-1, 1]
  std::vector<Material> materials;
  for (const Mass& mass : places.masses) {
    const auto [x, y, z] = mass.rest;
    materials.push_back({5000 * (1 + x), 0.3 * y, 4 * z, 40 * x * y});
  }
  return materials;
}

TEST(ComputedMaterials, ThePapersAndTheirMeansAreExact) {
  const std::vector<Material> paper{{5000, 0.14, 1, 0}, {4000, 0, 0, 0}, {5000, 0.14, 1, pi}, {10000, 0, 0, 0}};
  std::vector<Material> all;
  for (const Material& a : paper)
    for (const Material& b : paper) all.push_back(mean(a, b));
  const std::vector<Material> simulated = simulated_materials(all, Materials::computed);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_DOUBLE_EQ(simulated[i].stiffness, all[i].stiffness);
    EXPECT_DOUBLE_EQ(simulated[i].amplitude, all[i].amplitude);
    EXPECT_DOUBLE_EQ(simulated[i].frequency, all[i].frequency);
    EXPECT_DOUBLE_EQ(simulated[i].phase, all[i].phase);
  }
}

TEST(ComputedMaterials, OthersAreOffByHalfAUnitAtMost) {
  const std::vector<Material> materials = random_materials(2000);
  const MaterialUnits units = material_units(materials);
  const std::vector<Material> simulated = simulated_materials(materials, Materials::computed);
  const double rounding = 1 + 1e-9, half_phase = pi / 4096;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    const Material &given = materials[i], &rounded = simulated[i];
    EXPECT_NEAR(rounded.stiffness, given.stiffness, units.stiffness / 2 * rounding);
    EXPECT_NEAR(rounded.amplitude, std::abs(given.amplitude), units.amplitude / 2 * rounding);
    EXPECT_NEAR(rounded.frequency, std::abs(given.frequency), units.frequency / 2 * rounding);
    // the same motion, whatever the signs
    const double amplitude = std::abs(given.amplitude), time = 2.3;
    EXPECT_NEAR(rounded.relative_length(time), given.relative_length(time),
                (units.amplitude / 2 + amplitude * (half_phase + 2 * pi * units.frequency / 2 * time)) * rounding)
        << i;
  }
}

TEST(ComputedMaterials, CodesHaveRoomForTheLargest) {
  const std::vector<Material> materials{{1e9, 0.9, 1e3, 2 * pi * (1 - 1e-9)}, {0, 0, 0, 0}};
  const MaterialUnits units = material_units(materials);
  const MaterialCode largest = code_of(materials[0], units);
  EXPECT_LT(largest.stiffness, 1u << 16);
  EXPECT_EQ(largest.wave >> phase_shift, 0u) << "a whole turn is none";
  const Material back = material_of(largest, units);
  EXPECT_DOUBLE_EQ(back.stiffness, 1e9);
  EXPECT_DOUBLE_EQ(back.amplitude, 0.9);
  EXPECT_DOUBLE_EQ(back.frequency, 1e3);
  EXPECT_EQ(material_of(code_of(materials[1], units), units), Material{});
  EXPECT_EQ(simulated_materials({{Material{}}}, Materials::computed), std::vector<Material>{Material{}}) << "no units";
}

class ComputedMaterialsOnTheCpu : public testing::TestWithParam<Arithmetic> {};

INSTANTIATE_TEST_SUITE_P(Methods, ComputedMaterialsOnTheCpu,
                         testing::Combine(testing::ValuesIn(all_methods),
                                          testing::Values(Precision::float32, Precision::float64)),
                         [](const auto& instance) { return name_of(instance.param); });

TEST_P(ComputedMaterialsOnTheCpu, AreThoseOfTheCodes) {
  const auto [method, precision] = GetParam();
  Body body = random_body(60, 10, 1, 5);
  body.materials = random_materials(body.springs.size());
  for (std::uint32_t i = 0; i < body.springs.size(); ++i) body.springs[i].material = i;
  Body rounded = body;
  rounded.materials = simulated_materials(body.materials, Materials::computed);
  const Scene scene{Gravity{}, {}, {}, Damping{}, {}};
  const State start = resting(body, scene);
  const auto moved = [&, method = method, precision = precision](const Body& b, Materials materials) {
    State state = start;
    Task task{.body = &b, .state = &state, .steps = 120};
    make_cpu_simulator(scene, {method, precision, materials}, 1)->run({&task, 1}, {});
    EXPECT_EQ(task.status, Status::ok) << task.reason;
    return state.position;
  };
  EXPECT_EQ(moved(body, Materials::computed), moved(rounded, Materials::table));
  EXPECT_NE(moved(body, Materials::computed), moved(body, Materials::table));
}

}  // namespace
}  // namespace evodevo::test
