// Springs whose stiffness differs from that of their material by a factor.
#include <gtest/gtest.h>

#include <memory>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "analysis/energy.hpp"
#include "analysis/split_materials.hpp"
#include "analysis/stability.hpp"
#include "support.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

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
  std::vector<Body> forms(8, varied_body());
  for (Material& material : forms[0].materials) material.damping = 0.3;
  for (std::size_t i = 1; i < forms.size(); ++i) {
    forms[i] = forms[i - 1];
    Body& body = forms[i];
    if (i == 1) body.springs[7].rest_length *= 1.37;
    if (i == 2) body.masses[5].mass *= 1.7;  // changes the dashpots of its springs
    if (i == 3) body.materials[1].phase += 0.7;
    if (i == 4) body.springs[9].stiffness_factor *= 1.3;
    if (i == 5) body.springs[11].material = (body.springs[11].material + 1) % body.materials.size();
    if (i == 6) body.springs.pop_back();
    if (i == 7) body.masses[3].rest.x += 0.1;
  }
  expect_split_to_follow(forms);
}

TEST(StiffnessFactors, EndToBePartsOfMaterialsWithThem) {
  Body plain = varied_body();
  for (Spring& spring : plain.springs) spring.stiffness_factor = 1;
  expect_split_to_follow(std::vector<Body>{varied_body(), plain, varied_body()});
}

TEST(StiffnessFactors, AreNotSplitAgainIfOnlyLengthsChange) {
  const Body body = varied_body();
  Body longer = body, heavier = body;
  longer.springs[0].rest_length *= 1.1;
  heavier.masses[0].mass *= 1.1;
  auto split = SplitBody::of(body, nullptr);
  const SplitBody* const first = split.get();
  const std::weak_ptr<SplitBody> observed = split;
  split = SplitBody::of(longer, std::move(split));
  EXPECT_EQ(split.get(), first);
  split = SplitBody::of(heavier, std::move(split));
  EXPECT_TRUE(observed.expired());
}

TEST(StiffnessFactors, OfCopiedLivesFollowEachLife) {
  const Body body = varied_body();
  const auto shared = SplitBody::of(body, nullptr);
  Body longer = body;
  longer.springs[0].rest_length *= 1.1;
  const auto own = SplitBody::of(longer, shared);
  EXPECT_EQ(own->body().springs[0].rest_length, longer.springs[0].rest_length);
  EXPECT_EQ(shared->body().springs[0].rest_length, body.springs[0].rest_length) << "that of the other life";
}

TEST(StiffnessFactors, CountInEnergyAndTimeStep) {
  const Body body = varied_body(), other = with_a_material_for_each(body);
  const Scene scene = walking_scene();
  State state = resting(body, scene);
  for (Vec3& place : state.position) place = 1.1 * place;
  EXPECT_DOUBLE_EQ(total_energy(body, state, scene), total_energy(other, state, scene));
  for (const Method method : explicit_methods)
    EXPECT_DOUBLE_EQ(largest_dt(body, state.position, method, 1), largest_dt(other, state.position, method, 1));
}

class StiffnessFactorsInMotion : public ::testing::TestWithParam<Arithmetic> {
 protected:
  static Answer moved(const Body& body, Materials materials) {
    const auto [method, precision] = GetParam();
    const Scene scene{Gravity{}, {}, {}, Damping{}, {}};
    Answer answer{{}, resting(body, scene)};
    answer.task = {.body = &body, .state = &answer.state, .dt = 0.0002, .steps = 300};
    make_cpu_simulator(scene, {method, precision, materials}, 1)
        ->run({&answer.task, 1}, {.stress = true, .work = true, .tension = true});
    EXPECT_EQ(answer.task.status, Status::ok) << answer.task.reason;
    return answer;
  }
};

INSTANTIATE_TEST_SUITE_P(Methods, StiffnessFactorsInMotion,
                         ::testing::Combine(::testing::ValuesIn(all_methods),
                                            ::testing::Values(Precision::float32, Precision::float64)),
                         [](const auto& instance) { return name_of(instance.param); });

TEST_P(StiffnessFactorsInMotion, AreLikeMaterialsWithThisStiffness) {
  const Body body = varied_body(), other = with_a_material_for_each(body);
  for (const Materials materials : {Materials::table, Materials::computed}) {
    const Answer with = moved(body, materials), without = moved(other, materials);
    EXPECT_TRUE(same_bits(with.state, without.state));
    EXPECT_EQ(with.task.stress, without.task.stress);
    EXPECT_EQ(with.task.tension, without.task.tension);
    EXPECT_EQ(with.task.work, without.task.work);
    EXPECT_EQ(with.task.body, &body);
  }
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
