// Devo operators see the same contact of masses with the ground on both devices.
#include <gmock/gmock.h>

#include "evolution/breeding.hpp"
#include "gpu.hpp"
#include "support/told.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

using testing::Told;

/// Returns the share of contact of the masses of ten developing robots after each cycle.
std::vector<std::vector<double>> contact_on(Simulator& simulator, const Experiment& experiment) {
  const Evaluation evaluation(experiment, simulator);
  const std::vector<Individual> individuals = breed(experiment, {}, 0, 0, 10);
  std::vector<Newborn> newborns;
  for (const Individual& individual : individuals) newborns.push_back({individual.id, 0, &individual.genome});
  std::vector<Life> lives = evaluation.birth.of(newborns);
  evaluation.development.run(lives, [](double) {});
  std::vector<std::vector<double>> contact;
  for (const Life& life : lives) contact.push_back(life.living.contact);
  return contact;
}

/// Compares the contact of masses on both devices.
void compare_contact(const Way& way, const Floor& floor) {
  // a mass that rests on the stiff floor bounces microscopically; from about 0.05 s on, rounding decides in which steps
  // it touches the floor
  Experiment experiment = testing::with({Told({.contact = true}, [](const DevoContext&, Edits&) {})},
                                        {{"development.cycles", "2", ""}, {"development.cycle_time", "0.02", ""}});
  experiment.stepping = stepping(way);
  experiment.scene.floor = floor;
  const auto cpu = contact_on(*make_cpu_simulator(experiment.scene, experiment.stepping, 0), experiment);
  const auto gpu = contact_on(*make_cuda_simulator(experiment.scene, experiment.stepping), experiment);
  ASSERT_EQ(gpu.size(), cpu.size());
  double most = 0;
  for (std::size_t i = 0; i < cpu.size(); ++i) {
    ASSERT_EQ(gpu[i].size(), cpu[i].size()) << i;
    for (std::size_t mass = 0; mass < cpu[i].size(); ++mass) {
      EXPECT_NEAR(gpu[i][mass], cpu[i][mass], 0.03) << i << ' ' << mass << ": one of 40 steps";
      most = std::max(most, gpu[i][mass]);
    }
  }
  EXPECT_GT(most, 0.9) << "some masses rest on the ground";
}

class ContactRecord : public ::testing::TestWithParam<Way> {};

TEST_P(ContactRecord, AgreesWithTheCpu) {
  EVODEVO_NEEDS_GPU();
  compare_contact(GetParam(), {});
}

TEST_P(ContactRecord, AgreesWithTheCpuOnRigidGround) {
  EVODEVO_NEEDS_GPU();
  if (std::get<Precision>(GetParam()) == Precision::float64) return;
  for (const double restitution : {0.0, 0.5})
    for (const double roughness : {0.0, 0.05})
      compare_contact(GetParam(), {.roughness = roughness, .restitution = restitution});
}

INSTANTIATE_TEST_SUITE_P(Gpu, ContactRecord, all_ways(), [](const auto& test) { return name(test.param); });

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
