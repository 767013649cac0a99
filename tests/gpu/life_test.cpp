// Devo operators see the same contact of masses with the ground on both devices, and verification before the front
// finds the same.
#include <gmock/gmock.h>

#include "evolution/breeding.hpp"
#include "gpu.hpp"
#include "life/evaluation.hpp"
#include "life/verification/verification.hpp"
#include "support/pairs.hpp"
#include "support/told.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

using testing::exaggerated, testing::measured_step, testing::Told;

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

class ContactRecord : public EachWayOnGpu {};

INSTANTIATE_TEST_SUITE_P(Gpu, ContactRecord, all_ways(), named);

TEST_P(ContactRecord, AgreesWithTheCpu) {
  // a mass that rests on the stiff floor bounces microscopically; from about 0.05 s on, rounding decides in which steps
  // it touches the floor
  Experiment experiment = testing::with({Told({.contact = true}, [](const DevoContext&, Edits&) {})},
                                        {{"development.cycles", "2", ""}, {"development.cycle_time", "0.02", ""}});
  experiment.stepping = way();
  experiment.scene.floor = Floor{};
  const auto on_cpu = contact_on(*cpu(experiment.scene, 0), experiment);
  const auto on_gpu = contact_on(*gpu(experiment.scene), experiment);
  ASSERT_EQ(on_gpu.size(), on_cpu.size());
  double most = 0;
  for (std::size_t i = 0; i < on_cpu.size(); ++i) {
    ASSERT_EQ(on_gpu[i].size(), on_cpu[i].size()) << i;
    for (std::size_t mass = 0; mass < on_cpu[i].size(); ++mass) {
      EXPECT_NEAR(on_gpu[i][mass], on_cpu[i][mass], 0.03) << i << ' ' << mass << ": one of 40 steps";
      most = std::max(most, on_gpu[i][mass]);
    }
  }
  EXPECT_GT(most, 0.9) << "some masses rest on the ground";
}

TEST(Lives, ScoreTheSameInAnyBatch) {
  EVODEVO_NEEDS_GPU();
  const Experiment experiment =
      testing::small({"experiment.lives=3", "experiment.birth_noise=0.01", "development.draws_between_lives=new",
                      "scenario=[{name='hurt', damage=0.2, start_noise=0.01, repeat=2}]"});
  const std::vector<Individual> robots = breed(experiment, {}, 0, 0, 30);
  const auto simulator = make_cuda_simulator(experiment.scene, experiment.stepping);
  const Evaluation evaluation(experiment, *simulator);
  const auto lives_of = [&](std::uint32_t first, std::uint32_t count) {
    std::vector<Newborn> newborns;
    for (const Individual& robot : robots)
      newborns.push_back({.id = robot.id, .genome = &robot.genome, .life = first, .lives = count});
    return newborns;
  };
  const std::vector<Newborn> all = lives_of(1, 3), last = lives_of(3, 1);
  const std::vector<Result> together = evaluation.evaluate(all, [](double) {});
  std::size_t ok = 0;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const Result alone = evaluation.evaluate({&all[i], 1}, [](double) {}).front();
    EXPECT_EQ(alone.status, together[i].status) << i;
    EXPECT_EQ(alone.lives, together[i].lives) << i;
    EXPECT_EQ(alone.records, together[i].records) << i;
    if (together[i].status != Status::ok) continue;
    EXPECT_EQ(evaluation.evaluate({&last[i], 1}, [](double) {}).front().objectives, together[i].lives.back()) << i;
    ++ok;
  }
  EXPECT_GT(ok, 10u);
}

TEST(Verification, FindsTheSameOnBothDevices) {
  EVODEVO_NEEDS_GPU();
  const Experiment experiment = testing::pairs();
  const double swing = std::numbers::pi / measured_step;  // half a period until it is measured
  std::vector<Genome> genomes;
  for (const auto& [h, is_passive] :
       {std::pair{swing, 0.0F}, {exaggerated(2.3), 0.0F}, {swing, 1.0F}, {swing * 2 / 3, 0.0F}})
    genomes.push_back({static_cast<float>(h), is_passive});
  std::vector<Newborn> newborns;
  for (const Genome& genome : genomes) newborns.push_back({static_cast<std::uint32_t>(newborns.size()), 0, &genome});
  const auto marks_on = [&](Simulator& simulator) {
    const std::vector<Result> results = Evaluation(experiment, simulator).evaluate(newborns, [](double) {});
    std::vector<Champion> champions;
    for (std::size_t i = 0; i < newborns.size(); ++i) champions.push_back({newborns[i], results[i].objectives.at(0)});
    std::vector<std::string> found;
    for (const Verification& verification :
         verify_marks(experiment, simulator, exact_simulators(experiment, simulator), champions, 0))
      found.push_back(marks_text(verification, true));
    return found;
  };
  const auto expected = ::testing::ElementsAre("verified", "artefact", "passive", "verified");
  EXPECT_THAT(marks_on(*make_cpu_simulator(experiment.scene, experiment.stepping, 2)), expected);
  EXPECT_THAT(marks_on(*make_cuda_simulator(experiment.scene, experiment.stepping, 2)), expected);
}

}  // namespace
}  // namespace evodevo::testing_gpu::EVODEVO_FILE
