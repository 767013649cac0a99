// Materials encoded in springs' codes: they are close to the given materials, and the same on the CPU and for the GPU.
#include "analysis/computed_materials.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

/// Random materials, some of them muscles.
std::vector<Material> random_materials(std::size_t count) {
  const Body places = random_body(static_cast<std::uint32_t>(count), 1, 1, 3);  // coordinates in [-1, 1]
  std::vector<Material> materials;
  for (const Mass& mass : places.masses) {
    const auto [x, y, z] = mass.rest;
    materials.push_back({5000 * (1 + x), 0.3 * y, 4 * z, 40 * x * y});
  }
  return materials;
}

/// Two masses joined by a spring of each material.
Body body_of(std::vector<Material> materials) {
  Body body;
  body.masses.resize(2);
  for (std::uint32_t i = 0; i < materials.size(); ++i) body.springs.push_back({0, 1, 1, i});
  body.materials = std::move(materials);
  return body;
}

TEST(ComputedMaterials, ThePapersAndTheirMeansAreExact) {
  const std::vector<Material> paper{{5000, 0.14, 1, 0}, {4000, 0, 0, 0}, {5000, 0.14, 1, pi}, {10000, 0, 0, 0}};
  std::vector<Material> all;
  for (const Material& a : paper)
    for (const Material& b : paper) all.push_back(mean(a, b));
  const std::vector<Material> simulated = simulated_materials(body_of(all), Materials::computed);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_DOUBLE_EQ(simulated[i].stiffness, all[i].stiffness);
    EXPECT_DOUBLE_EQ(simulated[i].amplitude, all[i].amplitude);
    EXPECT_DOUBLE_EQ(simulated[i].frequency, all[i].frequency);
    EXPECT_DOUBLE_EQ(simulated[i].phase, all[i].phase);
  }
}

TEST(ComputedMaterials, OthersAreOffByHalfAUnitAtMost) {
  const std::vector<Material> materials = random_materials(2000);
  const MaterialUnits units = material_units(body_of(materials));
  const std::vector<Material> simulated = simulated_materials(body_of(materials), Materials::computed);
  const double rounding = 1 + 1e-9, half_phase = pi / 4096;
  for (std::size_t i = 0; i < materials.size(); ++i) {
    const Material &given = materials[i], &rounded = simulated[i];
    const bool is_least = given.stiffness > 0 && given.stiffness < units.stiffness / 2;
    EXPECT_NEAR(rounded.stiffness, given.stiffness, units.stiffness / (is_least ? 1 : 2) * rounding);
    EXPECT_NEAR(rounded.amplitude, std::abs(given.amplitude), units.amplitude / 2 * rounding);
    EXPECT_NEAR(rounded.frequency, std::abs(given.frequency), units.frequency / 2 * rounding);
    // the motion is the same even if signs of amplitude and frequency have been changed
    const double amplitude = std::abs(given.amplitude), time = 2.3;
    EXPECT_NEAR(rounded.relative_length(time), given.relative_length(time),
                (units.amplitude / 2 + amplitude * (half_phase + 2 * pi * units.frequency / 2 * time)) * rounding)
        << i;
  }
}

TEST(ComputedMaterials, CodesHaveRoomForTheLargest) {
  const std::vector<Material> materials{{1e9, 0.9, 1e3, 2 * pi * (1 - 1e-9)}, {0, 0, 0, 0}};
  const MaterialUnits units = material_units(body_of(materials));
  const MaterialCode largest = code_of(materials[0], units);
  EXPECT_LT(largest.stiffness, 1u << 16);
  EXPECT_EQ(largest.wave >> phase_shift, 0u) << "a whole turn is none";
  const Material back = material_of(largest, units);
  EXPECT_DOUBLE_EQ(back.stiffness, 1e9);
  EXPECT_DOUBLE_EQ(back.amplitude, 0.9);
  EXPECT_DOUBLE_EQ(back.frequency, 1e3);
  EXPECT_EQ(material_of(code_of(materials[1], units), units), Material{});
  EXPECT_EQ(simulated_materials(body_of({Material{}}), Materials::computed), std::vector<Material>{Material{}})
      << "no units";
}

TEST(ComputedMaterials, NoSpringIsTooSoftToHaveAForce) {
  const Body body = body_of({{10000, 0.2, 2, 0}, {1e-3, 1e-9, 1e-9, 0}});
  const MaterialUnits units = material_units(body);
  const Material soft = simulated_materials(body, Materials::computed)[1];
  EXPECT_EQ(soft.stiffness, units.stiffness);
}

TEST(ComputedMaterials, WhatNoSpringHasDecidesNothing) {
  const Body body = body_of({{5037, 0.1234, 1.07, 1}});
  Body with_more = body;
  with_more.materials.push_back({1e7, 0.9, 30, 0});
  EXPECT_EQ(simulated_materials(with_more, Materials::computed)[0], simulated_materials(body, Materials::computed)[0]);
  EXPECT_EQ(simulated_materials(with_more, Materials::computed)[1], with_more.materials[1]);
}

class ComputedMaterialsOnTheCpu : public ::testing::TestWithParam<Arithmetic> {};

INSTANTIATE_TEST_SUITE_P(Methods, ComputedMaterialsOnTheCpu,
                         ::testing::Combine(::testing::ValuesIn(all_methods),
                                            ::testing::Values(Precision::float32, Precision::float64)),
                         [](const auto& instance) { return name_of(instance.param); });

TEST_P(ComputedMaterialsOnTheCpu, AreThoseOfTheCodes) {
  const auto [method, precision] = GetParam();
  Body body = random_body(60, 10, 1, 5);
  body.materials = random_materials(body.springs.size());
  for (std::uint32_t i = 0; i < body.springs.size(); ++i) body.springs[i].material = i;
  Body rounded = body;
  rounded.materials = simulated_materials(body, Materials::computed);
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
}  // namespace evodevo::test::EVODEVO_FILE
