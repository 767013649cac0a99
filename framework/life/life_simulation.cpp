#include "life/life_simulation.hpp"

#include <algorithm>
#include <utility>

#include "experiment/time_steps.hpp"

namespace evodevo {
namespace {

bool shows_parts(const Channels& channels) {
  return channels.positions || channels.velocities || channels.contacts || channels.forces;
}

/// Converts a sample to one that counts from birth.
StoredSample stored(Sample& sample, const Channels& channels, double dt, Life& life) {
  LivingBody& living = life.living;
  StoredSample kept{.time = sample.time,
                    .centre = sample.centre,
                    .velocity = sample.velocity,
                    .box = sample.box,
                    .contact_time = life.contact_time,
                    .work = life.work + sample.work,
                    .positions = std::move(sample.positions),
                    .velocities = std::move(sample.velocities),
                    .contact_times = {},
                    .forces = std::move(sample.forces),
                    .version = nullptr};
  if (!living.body.masses.empty())
    kept.contact_time +=
        dt * static_cast<double>(sample.contact_steps) / static_cast<double>(living.body.masses.size());
  if (!sample.contacts.empty()) living.contact_times.resize(sample.contacts.size(), 0);
  for (std::size_t i = 0; i < sample.contacts.size(); ++i)
    kept.contact_times.push_back(living.contact_times[i] + dt * sample.contacts[i]);
  if (!shows_parts(channels)) return kept;
  if (!living.version)
    living.version = std::make_shared<const BodyVersion>(BodyVersion{living.body, living.numbers.numbers()});
  kept.version = living.version;
  return kept;
}

/// Returns the share of a task's steps after which each mass touched the ground.
std::vector<double> contact_shares(const Sample& end, std::uint64_t steps) {
  std::vector<double> shares;
  for (const std::uint32_t contacts : end.contacts)
    shares.push_back(static_cast<double>(contacts) / static_cast<double>(std::max<std::uint64_t>(1, steps)));
  return shares;
}

/// Moves the samples of a task into its life. If anything is counted, the last sample is only there to count on.
void keep_samples(Task& task, const Stretch& stretch, Life& life) {
  const Channels& counted = stretch.counted;
  const std::size_t asked = task.samples.size() - (stretch.at_end().any() ? 1 : 0);
  for (std::size_t i = 0; i < asked; ++i)
    life.samples.push_back(stored(task.samples[i], task.sampled_at[i].channels, task.dt, life));
  if (stretch.contact) life.living.contact = contact_shares(task.samples.back(), task.steps);
  if (!counted.any()) return;
  if (!counted.contacts) task.samples.back().contacts.clear();
  StoredSample end = stored(task.samples.back(), {}, task.dt, life);
  life.contact_time = end.contact_time;
  life.work = end.work;
  if (counted.contacts) life.living.contact_times = std::move(end.contact_times);
}

}  // namespace

void LifeSimulation::choose_step(Life& life) const {
  LivingBody& living = life.living;
  LongestStep longest = longest_step(conditions_.step, living.body, *life.scene, conditions_.method);
  if (!longest.failure.empty()) return life.end(Status::invalid, std::move(longest.failure));
  living.longest_dt = longest.dt;
}

Task LifeSimulation::task_for(Life& life, const Stretch& stretch) const {
  const Pace pace = pace_of(stretch.duration, conditions_.step, life.living.longest_dt);
  Task task;
  task.body = &life.living.body;
  task.state = &life.living.state;
  task.dt = pace.dt;
  task.steps = pace.steps;
  task.scene = life.scene == &scene_ ? nullptr : life.scene;
  task.preparation = std::move(life.living.preparation);
  task.split = std::move(life.living.split);
  for (const auto& [time, channels] : stretch.samples)
    task.sampled_at.push_back({std::min(pace.steps_to(time), pace.steps), channels});
  if (stretch.at_end().any()) task.sampled_at.push_back({pace.steps, stretch.at_end()});
  return task;
}

void LifeSimulation::run(std::span<Life> lives, const Stretch& stretch, const Move& move) const {
  const BusyClock::Span span(clock_);
  std::vector<Task> tasks;
  std::vector<Life*> alive;
  for (Life& life : lives) {
    if (!life.alive()) continue;
    alive.push_back(&life);
    tasks.push_back(task_for(life, stretch));
  }
  move(std::span(tasks), std::span<Life* const>(alive));
  simulator_.workers().for_each(tasks.size(), [&](std::size_t i) {
    Life& life = *alive[i];
    Task& task = tasks[i];
    life.result.spring_evaluations += task.spring_evaluations;
    static_cast<SpringRecords&>(life.living) = std::move(static_cast<SpringRecords&>(task));
    static_cast<MassRecords&>(life.living) = {};
    life.living.preparation = std::move(task.preparation);
    life.living.split = std::move(task.split);
    if (task.status == Status::ok)
      keep_samples(task, stretch, life);
    else
      life.end(task.status, std::move(task.reason), task.ended_at);
  });
}

}  // namespace evodevo
