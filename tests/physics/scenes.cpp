#include "scenes.hpp"

#include <gtest/gtest.h>

#include "analysis/ground.hpp"

namespace evodevo::test {

void expect_tasks_in_their_own_scenes(const SimulatorFactory& simulator_for) {
  const Scene usual = walking_scene();
  Scene ice = usual, hills = usual, sea = {}, slope = usual, rock = usual;
  ice.friction->coefficient = 0.01;
  hills.floor->roughness = 0.05;
  sea.drag = Drag{2};
  slope.gravity->slope = 20;
  rock.floor->restitution = 0.5;
  const std::vector<const Scene*> scenes{nullptr, &ice, &hills, &sea, &slope, &rock, &usual};
  const Body body = random_body(60, 8, 5, 4);
  std::vector<State> states, alone;
  for (const Scene* scene : scenes) states.push_back(state_at_birth(body, scene != nullptr ? *scene : usual));
  alone = states;
  const auto task_of = [&](State& state) {
    return Task{.body = &body,
                .state = &state,
                .dt = 0.0004,
                .steps = 301,
                .sampled_at = {{150, {.centre = true, .contact = true}}}};
  };
  std::vector<Task> tasks;
  for (std::size_t i = 0; i < scenes.size(); ++i) tasks.emplace_back(task_of(states[i])).scene = scenes[i];
  simulator_for(usual)->run(tasks, {.work = true});
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    SCOPED_TRACE("scene " + std::to_string(i));
    Task task = task_of(alone[i]);
    simulator_for(scenes[i] != nullptr ? *scenes[i] : usual)->run({&task, 1}, {.work = true});
    EXPECT_EQ(task.status, Status::ok) << task.reason;
    EXPECT_EQ(tasks[i].status, task.status);
    EXPECT_TRUE(same_bits(states[i], alone[i]));
    EXPECT_EQ(states[i].start_energy, alone[i].start_energy);
    EXPECT_EQ(tasks[i].work, task.work);
    ASSERT_EQ(tasks[i].samples.size(), 1u);
    EXPECT_EQ(tasks[i].samples[0].centre, task.samples.at(0).centre);
    EXPECT_EQ(tasks[i].samples[0].contact_steps, task.samples[0].contact_steps);
    if (scenes[i] != nullptr && scenes[i] != &usual && scenes[i] != &ice) {
      EXPECT_FALSE(same_bits(states[i], states[0])) << "the scene has another force";
    }
  }
}

}  // namespace evodevo::test
