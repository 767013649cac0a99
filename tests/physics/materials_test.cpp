// Materials encoded in springs' codes: they are close to the given materials, and the same on the CPU and for the GPU.
// Springs whose stiffness differs from that of their material by a factor.
#include <cmath>
#include <functional>
#include <memory>
#include <span>
#include <tuple>

#include "analysis/computed_materials.hpp"
#include "analysis/energy.hpp"
#include "analysis/split_materials.hpp"
#include "analysis/stability.hpp"
#include "ways.hpp"

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

class ComputedMaterialsOnTheCpu : public EachWay {};

INSTANTIATE_TEST_SUITE_P(Methods, ComputedMaterialsOnTheCpu, all_ways(), named);

TEST_P(ComputedMaterialsOnTheCpu, AreThoseOfTheCodes) {
  Body body = random_body(60, 10, 1, 5);
  body.materials = random_materials(body.springs.size());
  for (std::uint32_t i = 0; i < body.springs.size(); ++i) body.springs[i].material = i;
  Body rounded = body;
  rounded.materials = simulated_materials(body, Materials::computed);
  const Scene scene{Gravity{}, {}, {}, Damping{}, {}};
  const State start = resting(body, scene);
  const auto moved = [&](const Body& b, Materials materials) {
    const Answer a = simulate(*make_cpu_simulator(scene, {method(), precision(), materials}, 1), b, start, 0.0005, 120);
    EXPECT_EQ(a.task.status, Status::ok) << a.task.reason;
    return a.state.position;
  };
  EXPECT_EQ(moved(body, Materials::computed), moved(rounded, Materials::table));
  EXPECT_NE(moved(body, Materials::computed), moved(body, Materials::table));
}

/// A random body with muscles; every spring has a factor from 0.5 to 1.5, some of them equal, and some 1.
Body varied_body() {
  Body body = random_body(60, 10, 5, 5);
  for (std::size_t i = 0; i < body.springs.size(); ++i)
    body.springs[i].stiffness_factor = 0.5 + static_cast<double>(i % 21) / 20;
  return body;
}

/// The same body, in which every spring has a material of its own instead.
Body with_a_material_for_each(Body body) {
  const std::vector<Material> shared = body.materials;
  body.materials.clear();
  for (Spring& spring : body.springs) {
    Material own = shared[spring.material];
    own.stiffness *= spring.stiffness_factor;
    spring.stiffness_factor = 1;
    spring.material = static_cast<std::uint32_t>(body.materials.size());
    body.materials.push_back(own);
  }
  return body;
}

TEST(StiffnessFactors, BecomePartsOfMaterials) {
  const Body body = varied_body();
  const auto plain = split_materials(body);
  ASSERT_NE(plain, nullptr);
  for (std::size_t i = 0; i < body.springs.size(); ++i) {
    EXPECT_EQ(plain->springs[i].stiffness_factor, 1);
    EXPECT_EQ(plain->stiffness(plain->springs[i]), body.stiffness(body.springs[i])) << i;
    const Material &shared = body.materials[body.springs[i].material],
                   &own = plain->materials[plain->springs[i].material];
    EXPECT_EQ(own.phase, shared.phase);
    EXPECT_EQ(own.amplitude, shared.amplitude);
  }
  EXPECT_LE(plain->materials.size(), 21 * body.materials.size()) << "one for each pair of material and factor";
  EXPECT_EQ(split_materials(*plain), nullptr);
}

/// Whether SplitBody::of() gives the same as split_materials() for each of these forms of a body, one after the other.
void expect_split_to_follow(std::span<const Body> forms) {
  std::shared_ptr<SplitBody> split;
  for (const Body& body : forms) {
    split = SplitBody::of(body, std::move(split));
    const auto anew = split_materials(body);
    ASSERT_EQ(split == nullptr, anew == nullptr);
    if (!split) continue;
    const Body& kept = split->body();
    ASSERT_EQ(kept.springs.size(), anew->springs.size());
    EXPECT_EQ(split_materials(kept), nullptr) << "springs of a material differ";
    for (std::size_t i = 0; i < kept.springs.size(); ++i) {
      const Spring &one = kept.springs[i], &other = anew->springs[i];
      EXPECT_EQ(std::tie(one.a, one.b, one.rest_length, one.stiffness_factor),
                std::tie(other.a, other.b, other.rest_length, other.stiffness_factor));
      EXPECT_EQ(kept.materials[one.material], anew->materials[other.material]) << i;
    }
    for (std::size_t i = 0; i < kept.masses.size(); ++i) {
      EXPECT_EQ(kept.masses[i].rest, body.masses[i].rest);
      EXPECT_EQ(kept.masses[i].mass, body.masses[i].mass);
    }
  }
}

TEST(StiffnessFactors, StayPartsOfMaterialsWhileABodyChanges) {
  const std::function<void(Body&)> changes[] = {
      [](Body& body) { body.springs[7].rest_length *= 1.37; },
      [](Body& body) { body.masses[5].mass *= 1.7; },  // changes the dashpots of its springs
      [](Body& body) { body.materials[1].phase += 0.7; },
      [](Body& body) { body.springs[9].stiffness_factor *= 1.3; },
      [](Body& body) { body.springs[11].material = (body.springs[11].material + 1) % body.materials.size(); },
      [](Body& body) { body.springs.pop_back(); },
      [](Body& body) { body.masses[3].rest.x += 0.1; },
      [](Body& body) {
        for (Spring& spring : body.springs) spring.stiffness_factor = 1;
        for (Material& material : body.materials) material.damping = 0;
      },
      [](Body& body) { body = varied_body(); }};
  std::vector<Body> forms{varied_body()};
  for (Material& material : forms[0].materials) material.damping = 0.3;
  for (const auto& change : changes) change(forms.emplace_back(Body(forms.back())));
  expect_split_to_follow(forms);
}

TEST(StiffnessFactors, AreNotSplitAgainIfOnlyLengthsOfOneLifeChange) {
  const Body body = varied_body();
  Body longer = body, heavier = body;
  longer.springs[0].rest_length *= 1.1;
  heavier.masses[0].mass *= 1.1;
  auto split = SplitBody::of(body, nullptr);
  const auto of_a_copied_life = SplitBody::of(longer, split);
  EXPECT_EQ(of_a_copied_life->body().springs[0].rest_length, longer.springs[0].rest_length);
  EXPECT_EQ(split->body().springs[0].rest_length, body.springs[0].rest_length) << "that of the other life";
  const SplitBody* const first = split.get();
  const std::weak_ptr<SplitBody> observed = split;
  split = SplitBody::of(longer, std::move(split));
  EXPECT_EQ(split.get(), first);
  split = SplitBody::of(heavier, std::move(split));
  EXPECT_TRUE(observed.expired());
}

TEST(StiffnessFactors, CountInEnergyAndTimeStep) {
  const Body body = varied_body(), other = with_a_material_for_each(body);
  const Scene scene = walking_scene();
  State state = resting(body, scene);
  for (Vec3& place : state.position) place = 1.1 * place;
  EXPECT_DOUBLE_EQ(total_energy(body, state, scene), total_energy(other, state, scene));
  for (const Method method : explicit_methods)
    EXPECT_DOUBLE_EQ(largest_dt_in_any_shape(body, {}, method, 1), largest_dt_in_any_shape(other, {}, method, 1));
}

class StiffnessFactorsInMotion : public EachWay {};

INSTANTIATE_TEST_SUITE_P(Methods, StiffnessFactorsInMotion, all_ways(), named);

TEST_P(StiffnessFactorsInMotion, AreLikeMaterialsWithThisStiffness) {
  const Scene scene{Gravity{}, {}, {}, Damping{}, {}};
  for (const Materials materials : {Materials::table, Materials::computed}) {
    const auto moved = [&](const Body& body) {
      const auto simulator = make_cpu_simulator(scene, {method(), precision(), materials}, 1);
      const Answer answer = simulate(*simulator, body, resting(body, scene), 0.0002, 300, all_records);
      EXPECT_EQ(answer.task.status, Status::ok) << answer.task.reason;
      return answer;
    };
    const Body body = varied_body(), other = with_a_material_for_each(body);
    const Answer with = moved(body), without = moved(other);
    EXPECT_TRUE(same_bits(with.state, without.state));
    for (const auto list : SpringRecords::lists) EXPECT_EQ(with.task.*list, without.task.*list);
    EXPECT_EQ(with.task.work, without.task.work);
    EXPECT_EQ(with.task.body, &body);
  }
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
