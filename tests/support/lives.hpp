// Newborns, their simulators, and short runs.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "archive/archive.hpp"
#include "cpu/simulator.hpp"
#include "engine/run.hpp"
#include "evolution/breeding.hpp"
#include "evolution/evolution.hpp"
#include "support/scratch.hpp"

namespace evodevo::testing {

inline std::vector<Newborn> newborns_of(const std::vector<Individual>& individuals) {
  std::vector<Newborn> newborns;
  for (const Individual& individual : individuals)
    newborns.push_back({individual.id, individual.born, &individual.genome});
  return newborns;
}

/// A first generation, whose later individuals have greater first scores.
inline std::vector<Individual> scored_population(const Experiment& experiment, std::uint32_t size) {
  std::vector<Individual> population = breed(experiment, {}, 0, 0, size);
  for (Individual& individual : population) individual.result.objectives = {1.0 + individual.id, 1};
  return population;
}

/// An encoding that makes the same body of any genome, of the materials of the experiment.
struct GivenBlueprint final : Encoding {
  Blueprint blueprint;

  explicit GivenBlueprint(Blueprint given) : blueprint(std::move(given)) {}
  Layout layout(const EncodingContext&) const override { return {}; }
  Blueprint decode(const Genome&, const Layout&, const EncodingContext& context) const override {
    Blueprint made = blueprint;
    made.body.materials = context.materials;
    return made;
  }
  std::vector<std::string> spring_memory() const override {
    std::vector<std::string> names;
    for (const auto& [name, numbers] : blueprint.spring_memory) names.push_back(name);
    return names;
  }
};

/// Expects that each individual lives alone, on one thread, exactly as it lives with the others on three. Returns
/// the results.
inline std::vector<Result> expect_independent_lives(const Experiment& experiment,
                                                    const std::vector<Individual>& individuals) {
  const std::vector<Newborn> newborns = newborns_of(individuals);
  const auto evaluate = [&](std::span<const Newborn> some, int threads) {
    const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, threads);
    return Evaluation(experiment, *simulator).evaluate(some, [](double) {});
  };
  std::vector<Result> together = evaluate(newborns, 3);
  for (std::size_t i = 0; i < together.size(); ++i) {
    const Result alone = evaluate({&newborns[i], 1}, 1).front();
    EXPECT_EQ(alone.status, together[i].status) << i;
    EXPECT_EQ(alone.reason, together[i].reason) << i;
    EXPECT_EQ(alone.objectives, together[i].objectives) << i;
    EXPECT_EQ(alone.lives, together[i].lives) << i;
    EXPECT_EQ(alone.spring_evaluations, together[i].spring_evaluations) << i;
    EXPECT_TRUE(alone.records == together[i].records) << i;
  }
  return together;
}

/// A simulator on the CPU, some functions of which a test replaces.
class AlteredSimulator : public Simulator {
 public:
  explicit AlteredSimulator(const Experiment& experiment, int threads = 1)
      : simulator_(make_cpu_simulator(experiment.scene, experiment.stepping, threads)) {}

  void run(std::span<Task> tasks, Recording recording) override { simulator_->run(tasks, recording); }
  NeighbourSearch& neighbours() override { return simulator_->neighbours(); }
  Workers& workers() override { return simulator_->workers(); }
  std::string device() const override { return simulator_->device(); }

 private:
  std::unique_ptr<Simulator> simulator_;
};

/// Continues a run until it has so many generations, or until it ends.
inline TimeSpent evolve_to(std::size_t generations, const Experiment& experiment, Archive& archive, int threads = 1) {
  std::atomic<bool> stop = false;
  Observer observer;
  observer.generation_done = [&](std::int64_t, const Summary& summary) {
    stop = summary.generation + 1 >= generations;
  };
  const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, threads);
  return evolve(experiment, *simulator, archive, stop, observer);
}

template <class Item>
std::vector<Item> alone(Item item) {
  std::vector<Item> items;
  items.push_back(std::move(item));
  return items;
}

/// A run with one population, of its parts.
inline evodevo::Run run_of(Experiment experiment, std::unique_ptr<Simulator> simulator, Archive archive) {
  return {alone(std::move(experiment)), std::move(simulator), alone(std::move(archive))};
}

/// A run that is finished.
struct FinishedRun {
  Scratch scratch;
  Experiment experiment;
  std::unique_ptr<Simulator> simulator = make_cpu_simulator(experiment.scene, experiment.stepping, 2);
  Archive archive = Archive::create(scratch / "run", experiment, simulator->device());

  explicit FinishedRun(Experiment of) : experiment(std::move(of)) {
    evolve(experiment, *simulator, archive, false, Observer{});
  }
};

/// The lives of newborns to the end of their development, and what they were at birth.
struct Developed {
  std::vector<LivingBody> born;
  std::vector<Life> lives;

  Developed(const Experiment& experiment, std::span<const Newborn> newborns, int threads = 2) {
    const auto simulator = make_cpu_simulator(experiment.scene, experiment.stepping, threads);
    const Evaluation evaluation(experiment, *simulator);
    lives = evaluation.birth.of(newborns);
    for (const Life& life : lives) born.push_back(life.living);
    evaluation.development.run(lives, [](double) {});
  }
  Developed(const Experiment& experiment, std::uint32_t count, int threads = 2)
      : Developed(experiment, newborns_of(breed(experiment, {}, 0, 0, count)), threads) {}
};

}  // namespace evodevo::testing
