#include "life/life_simulation.hpp"

#include <utility>

#include "experiment/time_steps.hpp"

namespace evodevo {

void LifeSimulation::choose_step(Life& life) const {
  LivingBody& living = life.living;
  LongestStep longest = longest_step(conditions_.step, living.body, living.state.position, scene_, conditions_.method);
  if (!longest.failure.empty()) return life.end(Status::invalid, std::move(longest.failure));
  living.longest_dt = longest.dt;
}

void LifeSimulation::run(std::span<Life> lives, double duration, const Move& move) const {
  const BusyClock::Span span(clock_);
  std::vector<Task> tasks;
  std::vector<Life*> alive;
  for (Life& life : lives) {
    if (!life.alive()) continue;
    alive.push_back(&life);
    Task& task = tasks.emplace_back();
    task.body = &life.living.body;
    task.state = &life.living.state;
    const Pace pace = pace_over(duration, conditions_.step, life.living.longest_dt);
    task.dt = pace.dt;
    task.steps = pace.steps;
    task.preparation = std::move(life.living.preparation);
  }
  move(std::span(tasks), std::span<Life* const>(alive));
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    Life& life = *alive[i];
    life.result.spring_evaluations += tasks[i].spring_evaluations;
    static_cast<SpringRecords&>(life.living) = std::move(static_cast<SpringRecords&>(tasks[i]));
    life.living.preparation = std::move(tasks[i].preparation);
    life.work += tasks[i].work;
    if (tasks[i].status != Status::ok) life.end(tasks[i].status, std::move(tasks[i].reason), tasks[i].ended_at);
  }
}

}  // namespace evodevo
