#include <gmock/gmock.h>

#include <cmath>
#include <numeric>

#include "analysis/computed_materials.hpp"
#include "analysis/energy.hpp"
#include "analysis/ground.hpp"
#include "analysis/sampling.hpp"
#include "analysis/stability.hpp"
#include "cases.hpp"
#include "core/piecewise.hpp"
#include "core/skip_shift.hpp"
#include "evodevo/rng.hpp"
#include "support/channels.hpp"

namespace evodevo::test {
namespace {

constexpr double dt = 0.0007;     // time step, s
constexpr double birthday = 3.1;  // start time of the simulation, s

Scene rough_slope() { return {Gravity{9.81, 12}, Floor{1e5, 0.05}, Friction{}, Damping{}, Drag{0.05}}; }

Scene rigid_slope() {
  return {Gravity{9.81, 12}, Floor{.roughness = 0.05, .restitution = 0.4}, Friction{0.5, 0.7}, Damping{}, Drag{0.05}};
}

State late(const Body& body, const Scene& scene) {
  State state = state_at_birth(body, scene);
  state.time = birthday;
  state.start_energy = total_energy(body, state, scene);
  return state;
}

/// The run of a body, whose time need not begin at 0.
struct Run {
  State state;
  Task task;

  Run(const Body& body, State start, double step = dt) : state(std::move(start)), task{.body = &body, .dt = step} {}

  /// Simulates all steps in pieces of the given numbers of steps.
  void make(Simulator& simulator, const std::vector<std::uint64_t>& pieces, Recording recording = {}) {
    task.state = &state;
    std::uint64_t later = std::accumulate(pieces.begin(), pieces.end(), std::uint64_t{0});
    for (const std::uint64_t steps : pieces) {
      if (task.status != Status::ok) break;
      later -= steps;
      task.steps = steps;
      task.later_steps = later;
      simulator.run({&task, 1}, recording);
    }
  }

  /// Simulates all steps in one piece, and expects that no check stops them.
  Run& complete(Simulator& simulator, std::uint64_t steps, Recording recording = all_records) {
    make(simulator, {steps}, recording);
    EXPECT_EQ(task.status, Status::ok) << task.reason;
    return *this;
  }
};

void expect_same(const Run& whole, const Run& pieces) {
  EXPECT_TRUE(same_bits(whole.state, pieces.state));
  EXPECT_EQ(whole.state.start_energy, pieces.state.start_energy);
  EXPECT_EQ(whole.task.status, pieces.task.status);
  EXPECT_EQ(whole.task.reason, pieces.task.reason);
  EXPECT_EQ(whole.task.ended_at, pieces.task.ended_at);
  EXPECT_FALSE(whole.task.course) << "nothing follows";
  EXPECT_FALSE(pieces.task.course) << "nothing follows";
}

void expect_one_verdict_on(const Body& body, const State& start, double step, const SimulatorFactory& simulator_for,
                           const Scene& scene) {
  const auto simulator = simulator_for(scene);
  Run whole(body, start, step), pieces = whole, recorded = whole;
  whole.make(*simulator, {1000});
  pieces.make(*simulator, std::vector<std::uint64_t>(40, 25));
  recorded.make(*simulator, {63, 937}, all_records);
  EXPECT_EQ(whole.task.status, Status::diverged);
  expect_same(whole, pieces);
  expect_same(whole, recorded);
}

}  // namespace

void expect_pieces_to_be_the_whole(const SimulatorFactory& simulator_for, const std::vector<Body>& bodies) {
  for (const Scene& scene : {rough_slope(), rigid_slope()})
    for (const Body& body : bodies) {
      SCOPED_TRACE(std::to_string(body.masses.size()) + " masses, " + (scene.floor->rigid() ? "rigid" : "elastic"));
      const auto simulator = simulator_for(scene);
      Run whole(body, late(body, scene)), pieces = whole, recorded = whole;
      whole.complete(*simulator, 500, {});
      pieces.make(*simulator, {1, 7, 100, 0, 137, 255});
      recorded.make(*simulator, {333, 167}, all_records);
      EXPECT_EQ(whole.state.time, birthday + 500 * dt);
      expect_same(whole, pieces);
      expect_same(whole, recorded);
    }
}

void expect_tallies_to_leave_the_motion_alone(const SimulatorFactory& simulator_for, const Body& body) {
  const Scene scene = rough_slope();
  const auto simulator = simulator_for(scene);
  Run whole(body, late(body, scene)), tallied = whole;
  whole.make(*simulator, {500});
  const auto counting = [](const std::uint32_t* counter, const std::uint32_t* key, std::uint32_t* out) {
    for (std::uint32_t i = 0; i < 4; ++i) out[i] = 2654435769u * (4 * counter[0] + i + key[0]);
  };
  Rng random(counting, {});
  tallied.task.state = &tallied.state;
  tallied.task.steps = 500;
  run_with_tallies(*simulator, {&tallied.task, 1}, 37,
                   [&](std::size_t, std::uint64_t) { return random_order(body.springs.size(), random); });
  expect_same(whole, tallied);
}

void expect_one_verdict(const SimulatorFactory& simulator_for, Method method) {
  const Body stiff = random_body(40, 8, 5, 3), sound = random_body(50, 10, 5, 2);
  Body unstable = stiff;
  for (Material& material : unstable.materials) material.stiffness *= 4000;
  const Scene scene = walking_scene();
  expect_one_verdict_on(unstable, late(unstable, scene), 0.0005, simulator_for, scene);
  // the initial energy switches the guard off, so that on the GPU only the range of forces can stop the body
  State start = late(sound, {});
  for (std::size_t i = 0; i < start.velocity.size(); ++i) start.velocity[i].x = 0.001 * static_cast<double>(i % 7);
  start.start_energy = 1e300;
  expect_one_verdict_on(sound, start, 1.3 * largest_dt(sound, start.position, method), simulator_for, {});
}

void expect_no_check_between_pieces(const SimulatorFactory& simulator_for) {
  // Energy falls from 1 J to 0.35 J at step 37, and below the bound of 0.2 J before step 100.
  const Scene scene{{}, {}, {}, Damping{20}, {}};
  const Body body = single_mass(0.2);
  State start = resting(body, scene);
  start.velocity[0] = {std::sqrt(10.0), 0, 0};
  start.start_energy = 0.02;
  const auto simulator = simulator_for(scene);
  Run whole(body, start), pieces = whole, short_run = whole;
  whole.complete(*simulator, 150, {});
  pieces.make(*simulator, {37, 60, 53});
  short_run.make(*simulator, {37});
  expect_same(whole, pieces);
  EXPECT_EQ(short_run.task.status, Status::diverged) << "the end of a run is checked";
}

namespace {

constexpr std::uint64_t length = 457;  // of a run with samples, steps

const Channels single_channels[] = {{.centre = true},    {.box = true},        {.contact = true},  {.work = true},
                                    {.positions = true}, {.velocities = true}, {.contacts = true}, {.forces = true}};

/// Steps that are neither evenly spaced nor all different.
std::vector<SamplePoint> awkward_points(Channels channels) {
  std::vector<SamplePoint> points;
  for (const std::uint64_t step : {0, 1, 2, 49, 50, 51, 99, 100, 100, 101, 150, 237, 300, 399, 456, 457})
    points.push_back({step, channels});
  return points;
}

Scene scene_with_everything() { return {Gravity{9.81, 7}, Floor{1e5, 0.03}, Friction{}, Damping{}, Drag{0.05}}; }

/// A run that no guard stops.
Run unguarded(const Body& body, const Scene& scene) {
  Run run(body, late(body, scene));
  run.state.start_energy = 1e300;
  return run;
}

void expect_same_run(const Run& a, const Run& b) {
  EXPECT_TRUE(same_bits(a.state, b.state));
  EXPECT_EQ(a.state.start_energy, b.state.start_energy);
  EXPECT_EQ(a.task.work, b.task.work);
  for (const auto list : SpringRecords::lists) EXPECT_EQ(a.task.*list, b.task.*list);
}

void expect_close(const Vec3& a, const Vec3& b, double tolerance) { EXPECT_LE(norm(a - b), tolerance); }

double largest_force(const Body& body) {
  double largest = 0;
  for (const Spring& spring : body.springs)
    largest = std::max(largest, body.materials[spring.material].stiffness * spring.rest_length);
  return largest;
}

}  // namespace

void expect_samples_to_change_nothing(const SimulatorFactory& simulator_for, const std::vector<Body>& bodies) {
  const Scene scene = scene_with_everything();
  const auto simulator = simulator_for(scene);
  for (const Body& body : bodies) {
    SCOPED_TRACE(std::to_string(body.masses.size()) + " masses");
    const Run start = unguarded(body, scene);
    Run bare = start, recorded = start, sampled = start, only_sampled = start;
    bare.complete(*simulator, length, {});
    recorded.complete(*simulator, length);
    sampled.task.sampled_at = only_sampled.task.sampled_at = awkward_points(all_channels);
    sampled.complete(*simulator, length);
    only_sampled.complete(*simulator, length, {});
    EXPECT_TRUE(same_bits(bare.state, recorded.state));
    EXPECT_TRUE(same_bits(bare.state, only_sampled.state));
    EXPECT_EQ(only_sampled.task.work, 0) << "not recorded";
    for (const Recording& recording : {Recording{.stress = true}, Recording{.stress = true, .work = true}}) {
      Run some = start;
      EXPECT_EQ(some.complete(*simulator, length, recording).task.stress, recorded.task.stress);
    }
    expect_same_run(recorded, sampled);
    ASSERT_EQ(sampled.task.samples.size(), sampled.task.sampled_at.size());
    for (const Channels& channels : single_channels) {
      Run one = start;
      one.task.sampled_at = awkward_points(channels);
      expect_same_run(recorded, one.complete(*simulator, length));
    }
  }
}

namespace {

/// Does what expect_samples_to_be_true() does. `preparation` is that of an earlier form of the body, or null.
void expect_true(Simulator& simulator, const Body& body, double rounding, Materials materials,
                 const std::shared_ptr<const Preparation>& preparation) {
  Body simulated = body;
  simulated.materials = simulated_materials(body, materials);
  const Scene scene = scene_with_everything();
  Run start = unguarded(body, scene);
  start.task.preparation = preparation;
  Run sampled = start;
  sampled.task.sampled_at = awkward_points(all_channels);
  sampled.complete(simulator, length);
  std::vector<std::uint32_t> before(body.masses.size(), 0);
  for (std::size_t i = 0; i < sampled.task.samples.size(); ++i) {
    const std::uint64_t step = sampled.task.sampled_at[i].step;
    SCOPED_TRACE("after step " + std::to_string(step));
    Run ended = start;
    ended.complete(simulator, step);
    const Sample& sample = sampled.task.samples[i];
    const Sample truth = sample_of(simulated, ended.state, ended.state.time, all_channels);
    EXPECT_EQ(sample.time, ended.state.time);
    expect_close(sample.centre, truth.centre, rounding);
    expect_close(sample.velocity, truth.velocity, 100 * rounding);
    expect_close(sample.box.low, truth.box.low, rounding);
    expect_close(sample.box.high, truth.box.high, rounding);
    EXPECT_EQ(sample.positions, truth.positions);
    EXPECT_EQ(sample.velocities, truth.velocities);
    EXPECT_THAT(sample.forces, ::testing::Pointwise(
                                   ::testing::FloatNear(static_cast<float>(2e-6 * largest_force(body))), truth.forces));
    EXPECT_NEAR(sample.work, ended.task.work, 1e-6 * (1 + ended.task.work));
    ASSERT_EQ(sample.contacts.size(), before.size());
    std::uint64_t sum = 0;
    for (std::size_t m = 0; m < before.size(); ++m) {
      EXPECT_TRUE(before[m] <= sample.contacts[m] && sample.contacts[m] <= step) << m;
      sum += sample.contacts[m];
    }
    EXPECT_EQ(sample.contact_steps, sum);
    before = sample.contacts;
  }
  EXPECT_GT(sampled.task.samples.back().contact_steps, 0u) << "it stands on the ground";
}

/// Removes every mass whose index is `first` modulo `every`, with its springs.
Body without(const Body& body, std::size_t first, std::size_t every) {
  Body left = body;
  left.masses.clear();
  std::vector<std::uint32_t> index(body.masses.size());
  for (std::size_t i = 0; i < body.masses.size(); ++i) {
    index[i] = static_cast<std::uint32_t>(left.masses.size());
    if (i % every != first) left.masses.push_back(body.masses[i]);
  }
  std::erase_if(left.springs, [&](const Spring& s) { return s.a % every == first || s.b % every == first; });
  for (Spring& spring : left.springs) spring.a = index[spring.a], spring.b = index[spring.b];
  return left;
}

}  // namespace

void expect_samples_to_be_true(const SimulatorFactory& simulator_for, const Body& body, double rounding,
                               Materials materials) {
  expect_true(*simulator_for(scene_with_everything()), body, rounding, materials, nullptr);
}

void expect_samples_to_be_true_after_removals(const SimulatorFactory& simulator_for, double rounding) {
  const Scene scene = scene_with_everything();
  const auto simulator = simulator_for(scene);
  const Body born = random_body(107, 9, 5, 6);
  Run life = unguarded(born, scene);
  life.complete(*simulator, 7);
  // with 90 masses, earlier indices up to 106 do not fit any more; with 98, they do and leave gaps
  for (const Body& left : {without(born, 2, 6), without(born, 3, 11)})
    expect_true(*simulator, left, rounding, Materials::table, life.task.preparation);
}

void expect_same_samples(const Sample& a, const Sample& b, double off_work) {
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.centre, b.centre);
  EXPECT_EQ(a.velocity, b.velocity);
  EXPECT_EQ(a.box.low, b.box.low);
  EXPECT_EQ(a.contact_steps, b.contact_steps);
  EXPECT_EQ(a.contacts, b.contacts);
  EXPECT_NEAR(a.work, b.work, off_work);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.velocities, b.velocities);
  EXPECT_EQ(a.forces, b.forces);
}

void expect_samples_in_pieces(const SimulatorFactory& simulator_for, const Body& body) {
  const Scene scene = scene_with_everything();
  const auto simulator = simulator_for(scene);
  Run whole = unguarded(body, scene);
  whole.task.sampled_at = awkward_points(all_channels);
  Run pieces = whole;
  whole.complete(*simulator, length);
  pieces.task.state = &pieces.state;
  pieces.task.steps = length;
  run_in_pieces(
      *simulator, {&pieces.task, 1}, {}, [](std::size_t) { return 73; }, [](std::size_t, const Task&) {});
  EXPECT_TRUE(same_bits(whole.state, pieces.state));
  ASSERT_EQ(whole.task.samples.size(), pieces.task.samples.size());
  for (std::size_t i = 0; i < whole.task.samples.size(); ++i) {
    SCOPED_TRACE("sample " + std::to_string(i));
    const Sample &a = whole.task.samples[i], &b = pieces.task.samples[i];
    expect_same_samples(a, b, 1e-6 * (1 + a.work));  // sums of work are divided at other steps
  }
}

void expect_contact_from_the_landing_on(const SimulatorFactory& simulator_for) {
  constexpr double height = 0.05, acceleration = 9.81;
  for (const double roughness : {0.0, 0.03}) {
    const Scene scene{Gravity{acceleration}, Floor{1e5, roughness}, {}, {}, {}};
    Body body = pair_of_masses(0.2, {0, 0, 0, 0});
    body.springs.clear();
    body.masses[1].mass = 0;  // held
    State state{{{0, 0, 0}, {1, 0, 0}}, {{}, {}}, 0, 1e300};
    put_on_ground(state.position, scene);
    for (Vec3& position : state.position) position.z = ground_height(scene, position) - 0.001;
    state.position[0].z += 0.001 + height;
    Task task{.body = &body, .state = &state, .dt = 1e-4, .steps = 3000};
    const auto landing = static_cast<std::uint64_t>(std::ceil(std::sqrt(2 * height / acceleration) / task.dt));
    const Channels contact{.contact = true, .contacts = true};
    task.sampled_at = {{landing - 5, contact}, {landing + 5, contact}, {3000, contact}};
    simulator_for(scene)->run({&task, 1}, {});
    ASSERT_EQ(task.samples.size(), 3u) << task.reason;
    EXPECT_EQ(task.samples[0].contacts, (std::vector<std::uint32_t>{0, static_cast<std::uint32_t>(landing - 5)}));
    EXPECT_GT(task.samples[1].contacts[0], 0u);
    EXPECT_LE(task.samples[1].contacts[0], 10u);
    EXPECT_EQ(task.samples[1].contacts[1], landing + 5);
    EXPECT_EQ(task.samples[1].contact_steps, task.samples[1].contacts[0] + landing + 5);
    // an elastic impact lasts for half a period of the floor's spring, pi sqrt(m/k), and a little longer by its weight
    const double impact = pi * std::sqrt(0.2 / 1e5) / task.dt;
    EXPECT_NEAR(task.samples[2].contacts[0], impact, 0.2 * impact);
  }
}

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
