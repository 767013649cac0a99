// Devo operators that do what a test says, and the lives that they develop.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "life/evaluation.hpp"
#include "support/experiments.hpp"
#include "support/lives.hpp"
#include "support/refusals.hpp"

namespace evodevo::testing {

inline const auto unwatched = [](double) {};

/// A devo operator that does what a test says.
struct Told final : Devo {
  RecordRequest request = {};
  std::vector<std::string> of_masses = {}, of_springs = {}, of_body = {};
  Traits claims = {};
  std::function<void(const DevoContext&, Edits&)> action = {};

  Told(RecordRequest wanted, std::function<void(const DevoContext&, Edits&)> then)
      : request(wanted), action(std::move(then)) {}
  Traits traits() const override { return claims; }
  RecordRequest observes() const override { return request; }
  std::vector<std::string> mass_memory() const override { return of_masses; }
  std::vector<std::string> spring_memory() const override { return of_springs; }
  std::vector<std::string> body_memory() const override { return of_body; }
  void develop(const DevoContext& context, Edits& edits, Rng&) const override { action(context, edits); }
};

/// A small experiment with these devo operators.
inline Experiment with(const std::vector<Told>& operators, std::vector<Override> overrides = {}) {
  Experiment experiment = read(small_experiment, std::move(overrides));
  experiment.devo.clear();
  for (const Told& told : operators) experiment.devo.push_back({std::make_unique<Told>(told), "told", {}});
  return experiment;
}

inline std::unique_ptr<Simulator> simulator_for(const Experiment& experiment, int threads = 1) {
  return make_cpu_simulator(experiment.scene, experiment.stepping, threads);
}

inline Life matured(const Experiment& experiment, std::vector<LifeRecord> records = {}) {
  static const Genome genome = {1, 2};
  const Newborn newborn{0, 0, &genome, std::move(records)};
  Life life = std::move(Developed(experiment, {&newborn, 1}, 1).lives.front());
  EXPECT_EQ(life.result.status, Status::ok) << life.result.reason;
  return life;
}

inline std::string error_of(const Experiment& experiment) {
  return refusal<std::runtime_error>([&] { matured(experiment); });
}

inline std::vector<double> numbers_of(std::span<const double> record) { return {record.begin(), record.end()}; }

/// Joins a new mass to the first two masses.
inline void add_mass(const DevoContext& context, Edits& edits) {
  const Box& box = context.bounds;
  const double part = 0.3 + 0.1 * static_cast<double>(edits.new_masses.size());
  const std::uint32_t newest = edits.add_mass(box.low + part * (box.high - box.low), {.material = 0});
  for (const std::uint32_t partner : {0, 1}) edits.join(partner, newest, Material{10000, 0, 0, 0});
}

inline constexpr RecordRequest all_of_masses{.contact = true, .age = true, .degree = true, .load = true};

}  // namespace evodevo::testing
