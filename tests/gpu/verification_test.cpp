// Verification before the front finds the same on both devices.
#include "life/verification.hpp"

#include <gmock/gmock.h>

#include "gpu.hpp"
#include "life/evaluation.hpp"
#include "support/pairs.hpp"

namespace evodevo::testing_gpu::EVODEVO_FILE {
namespace {

using evodevo::testing::exaggerated, evodevo::testing::measured_step;

TEST(Verification, FindsTheSameOnBothDevices) {
  EVODEVO_NEEDS_GPU();
  const Experiment experiment = evodevo::testing::pairs();
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
