#include "samples.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "analysis/computed_materials.hpp"
#include "analysis/ground.hpp"
#include "analysis/sampling.hpp"
#include "core/piecewise.hpp"
#include "support/channels.hpp"

namespace evodevo::test {
namespace {

constexpr double dt = 0.0007;  // s
constexpr std::uint64_t steps = 457;
constexpr Recording everything{true, true, true, true, true};

std::vector<Channels> single_channels() {
  return {{.centre = true},    {.box = true},        {.contact = true},  {.work = true},
          {.positions = true}, {.velocities = true}, {.contacts = true}, {.forces = true}};
}

/// Steps that are neither evenly spaced nor all different.
std::vector<SamplePoint> awkward_points(Channels channels) {
  std::vector<SamplePoint> points;
  for (const std::uint64_t step : {0, 1, 2, 49, 50, 51, 99, 100, 100, 101, 150, 237, 300, 399, 456, 457})
    points.push_back({step, channels});
  return points;
}

Scene scene_with_everything() { return {Gravity{9.81, 7}, Floor{1e5, 0.03}, Friction{}, Damping{}, Drag{0.05}}; }

/// A run whose time does not begin at 0.
struct Run {
  State state;
  Task task;

  Run(const Body& body, const Scene& scene, std::uint64_t length = steps) : state(state_at_birth(body, scene)) {
    state.time = 3.1;
    state.start_energy = 1e300;
    task.body = &body;
    task.dt = dt;
    task.steps = length;
  }
  Run(const Run&) = delete;

  Run& make(Simulator& simulator, Recording recording = everything) {
    task.state = &state;
    simulator.run({&task, 1}, recording);
    EXPECT_EQ(task.status, Status::ok) << task.reason;
    return *this;
  }
};

void expect_same_run(const Run& a, const Run& b) {
  EXPECT_TRUE(same_bits(a.state, b.state));
  EXPECT_EQ(a.state.start_energy, b.state.start_energy);
  EXPECT_EQ(a.task.work, b.task.work);
  for (const auto list : SpringRecords::lists) EXPECT_EQ(a.task.*list, b.task.*list);
}

void expect_close(double a, double b, double tolerance, const char* what) { EXPECT_NEAR(a, b, tolerance) << what; }

void expect_close(const Vec3& a, const Vec3& b, double tolerance, const char* what) {
  EXPECT_LE(norm(a - b), tolerance) << what;
}

void expect_close(const std::vector<float>& a, const std::vector<float>& b, double tolerance, const char* what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], tolerance) << what << " " << i;
}

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
    Run bare(body, scene), recorded(body, scene), sampled(body, scene), only_sampled(body, scene);
    bare.make(*simulator, {});
    recorded.make(*simulator);
    sampled.task.sampled_at = only_sampled.task.sampled_at = awkward_points(all_channels);
    sampled.make(*simulator);
    only_sampled.make(*simulator, {});
    EXPECT_TRUE(same_bits(bare.state, recorded.state));
    EXPECT_TRUE(same_bits(bare.state, only_sampled.state));
    EXPECT_EQ(only_sampled.task.work, 0) << "not recorded";
    expect_same_run(recorded, sampled);
    ASSERT_EQ(sampled.task.samples.size(), sampled.task.sampled_at.size());
    for (const Channels& channels : single_channels()) {
      Run one(body, scene);
      one.task.sampled_at = awkward_points(channels);
      expect_same_run(recorded, one.make(*simulator));
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
  Run sampled(body, scene);
  sampled.task.sampled_at = awkward_points(all_channels);
  sampled.task.preparation = preparation;
  sampled.make(simulator);
  std::vector<std::uint32_t> before(body.masses.size(), 0);
  for (std::size_t i = 0; i < sampled.task.samples.size(); ++i) {
    const std::uint64_t step = sampled.task.sampled_at[i].step;
    SCOPED_TRACE("after step " + std::to_string(step));
    Run ended(body, scene, step);
    ended.task.preparation = preparation;
    ended.make(simulator);
    const Sample& sample = sampled.task.samples[i];
    const Sample truth = sample_of(simulated, ended.state, ended.state.time, all_channels);
    EXPECT_EQ(sample.time, ended.state.time);
    expect_close(sample.centre, truth.centre, rounding, "centre");
    expect_close(sample.velocity, truth.velocity, 100 * rounding, "velocity of the centre");
    expect_close(sample.box.low, truth.box.low, rounding, "box");
    expect_close(sample.box.high, truth.box.high, rounding, "box");
    EXPECT_EQ(sample.positions, truth.positions);
    EXPECT_EQ(sample.velocities, truth.velocities);
    expect_close(sample.forces, truth.forces, 2e-6 * largest_force(body), "forces");
    expect_close(sample.work, ended.task.work, 1e-6 * (1 + ended.task.work), "work");
    ASSERT_EQ(sample.contacts.size(), before.size());
    std::uint64_t sum = 0;
    for (std::size_t m = 0; m < before.size(); ++m) {
      EXPECT_GE(sample.contacts[m], before[m]);
      EXPECT_LE(sample.contacts[m], step);
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
  Run life(born, scene, 7);
  life.make(*simulator);
  // with 90 masses, earlier indices up to 106 do not fit any more; with 98, they do and leave gaps
  for (const Body& left : {without(born, 2, 6), without(born, 3, 11)})
    expect_true(*simulator, left, rounding, Materials::table, life.task.preparation);
}

void expect_samples_in_pieces(const SimulatorFactory& simulator_for, const Body& body) {
  const Scene scene = scene_with_everything();
  const auto simulator = simulator_for(scene);
  Run whole(body, scene), pieces(body, scene);
  whole.task.sampled_at = pieces.task.sampled_at = awkward_points(all_channels);
  whole.make(*simulator);
  pieces.task.state = &pieces.state;
  run_in_pieces(
      *simulator, {&pieces.task, 1}, {}, [](std::size_t) { return 73; }, [](std::size_t, const Task&) {});
  EXPECT_TRUE(same_bits(whole.state, pieces.state));
  ASSERT_EQ(whole.task.samples.size(), pieces.task.samples.size());
  for (std::size_t i = 0; i < whole.task.samples.size(); ++i) {
    SCOPED_TRACE("sample " + std::to_string(i));
    const Sample &a = whole.task.samples[i], &b = pieces.task.samples[i];
    EXPECT_EQ(a.time, b.time);
    EXPECT_EQ(a.centre, b.centre);
    EXPECT_EQ(a.velocity, b.velocity);
    EXPECT_EQ(a.box.low, b.box.low);
    EXPECT_EQ(a.contact_steps, b.contact_steps);
    EXPECT_EQ(a.contacts, b.contacts);
    EXPECT_NEAR(a.work, b.work, 1e-6 * (1 + a.work)) << "sums are divided at other steps";
    EXPECT_EQ(a.positions, b.positions);
    EXPECT_EQ(a.velocities, b.velocities);
    EXPECT_EQ(a.forces, b.forces);
  }
}

void expect_contact_from_the_landing_on(const SimulatorFactory& simulator_for, bool rough) {
  constexpr double height = 0.05, g = 9.81;
  Scene scene{Gravity{g}, Floor{1e5}, {}, {}, {}};
  if (rough) scene.floor->roughness = 0.03;
  Body body = pair_of_masses(0.2, {0, 0, 0, 0});
  body.springs.clear();
  body.masses[1].mass = 0;  // held
  State state{{{0, 0, 0}, {1, 0, 0}}, {{}, {}}, 0, 1e300};
  put_on_ground(state.position, scene);
  for (Vec3& position : state.position) position.z = ground_height(scene, position) - 0.001;
  state.position[0].z += 0.001 + height;
  Task task{.body = &body, .state = &state, .dt = 1e-4, .steps = 3000};
  const auto landing = static_cast<std::uint64_t>(std::ceil(std::sqrt(2 * height / g) / task.dt));
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

}  // namespace evodevo::test
