// The kernels for each size of body, and for unusual bodies, give the same results as the CPU.
#include "gpu.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

/// A body for which there is a form of kernels.
struct Form {
  const char* name;
  Body (*body)();
  unsigned largest_cluster = default_cluster;
  enum { moves, rests, is_in_the_air } start = moves;  ///< in the air, it does not land: that magnifies rounding
};

template <std::uint32_t masses, std::uint32_t neighbours = 25>
Body sized() {
  return random_body(masses, neighbours, 5);
}

Body coincident_masses() {
  Body body;
  body.materials = paper_materials();
  body.masses = {{{0, 0, 0}, 0.2}, {{0, 0, 0}, 0.2}};
  body.springs = {{0, 1, 0.1, 0}};
  return body;
}

Body masses_of_no_weight() {
  Body body = random_body(100, 10, 6);
  body.masses[3].mass = body.masses[50].mass = 0;
  return body;
}

Body masses_of_many_springs() {
  Random random(3);
  Body body;
  body.materials = paper_materials();
  for (std::uint32_t i = 0; i < 700; ++i) {
    body.masses.push_back({random.vector(1), 0.2});
    if (i > 0) body.springs.push_back({0, i, norm(body.masses[i].rest - body.masses[0].rest), i % 4});
  }
  body.masses[0].mass = 50;
  return body;
}

/// A body whose springs have `count` materials with stiffnesses of 4,000 to 9,000 N/m, amplitudes up to 0.14 and all
/// phases; if `count` is 0, every spring has its own.
template <std::size_t count, std::uint32_t masses = 500>
Body of_materials() {
  const std::size_t number = count > 0 ? count : random_body(masses, 25, 4).springs.size();
  std::vector<Material> all;
  for (std::size_t i = 0; i < number; ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(number);
    all.push_back({4000 + 5000 * part, 0.14 * part, i % 2 == 0 ? 1.0 : 0.5, 2 * pi * part});
  }
  return random_body(masses, 25, 4, all);
}

Body chain() {
  Body body;
  body.materials = paper_materials();
  for (std::uint32_t i = 0; i < 2000; ++i) {
    body.masses.push_back({{0.05 * i, 0, 0}, 0.2});
    if (i > 0) body.springs.push_back({i - 1, i, 0.05, i % 4});
  }
  return body;
}

/// Each piece is a part of a cluster.
Body pieces() { return body_in_pieces(random_body(1000, 25, 6)); }

const Form unusual[] = {{"NoMasses", [] { return Body(); }},
                        {"OneMass", [] { return test::single_mass(0.2); }},
                        {"CoincidentMassesFeelNoForce", coincident_masses, default_cluster, Form::rests},
                        {"MassesOfNoWeightStayWhereTheyAre", masses_of_no_weight, default_cluster, Form::rests},
                        {"MassesOfManySprings", masses_of_many_springs},
                        {"Materials16", of_materials<16>},
                        {"Materials200", of_materials<200>},
                        {"Materials5000ATableOfOneStep", of_materials<5000>},
                        {"EverySpringItsOwnMaterial", of_materials<0, 1000>},
                        {"EverySpringItsOwnMaterialBeyondTheChip", of_materials<0, 3000>},
                        {"Chain", chain}};

/// Each method has its own kernels for each size.
const Form sizes[] = {{"Masses64", sized<64>},
                      {"Masses1000", sized<1000>},
                      {"Masses2000", sized<2000>},
                      {"Masses2000SpringsStreamed", sized<2000>, 1},
                      {"Masses4000OffsetsBeyond16Bits", sized<4000, 12>, 1},
                      {"Masses8000SpringsStreamedInAClusterOfTwo", sized<8000, 12>, 2, Form::is_in_the_air},
                      {"Masses20000", sized<20000, 12>},
                      {"Masses20000BeyondTheChip", sized<20000, 12>, 1},
                      {"PartsWithoutCutSprings", pieces, default_cluster, Form::is_in_the_air}};

class Forms : public ::testing::TestWithParam<std::tuple<Form, test::Arithmetic>> {};

TEST_P(Forms, MoveAndRecordAsOnTheCpuFor110Steps) {
  EVODEVO_NEEDS_GPU();
  const auto& [form, arithmetic] = GetParam();
  const Stepping stepping{std::get<Method>(arithmetic), std::get<Precision>(arithmetic)};
  const bool single = stepping.precision == Precision::float32;
  const Scene scene = walking_scene();
  const Body body = form.body();
  State start = form.start == Form::rests ? state_at_birth(body, scene) : moving_state(body, scene, 11);
  if (form.start == Form::is_in_the_air)
    for (Vec3& position : start.position) position.z += 0.5;
  Robot cpu(body, start), gpu(body, start);
  simulate(*make_cpu_simulator(scene, stepping, 0), {&cpu}, 110, all_records);
  simulate(*make_cuda_simulator(scene, stepping, 0, default_portion, form.largest_cluster), {&gpu}, 110, all_records);
  expect_agreement(cpu, gpu, single ? 3e-3 : 3e-9, single ? 5e-2 : 5e-8, single ? 1e-3 : 1e-9);
}

const auto named_form = [](const auto& test) {
  return std::string(std::get<Form>(test.param).name) + "_" + test::name_of(std::get<test::Arithmetic>(test.param));
};

// one method for each kind of kernel
INSTANTIATE_TEST_SUITE_P(Unusual, Forms,
                         ::testing::Combine(::testing::ValuesIn(unusual),
                                            test::ways({Method::paper_euler, Method::implicit, Method::xpbd})),
                         named_form);
INSTANTIATE_TEST_SUITE_P(Sizes, Forms, ::testing::Combine(::testing::ValuesIn(sizes), all_ways()), named_form);

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
