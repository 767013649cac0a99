// Properties of random bodies in random scenes, with a thousand bodies for each method.
#include <algorithm>
#include <cmath>

#include "analysis/energy.hpp"
#include "random_lives.hpp"
#include "ways.hpp"

namespace evodevo::test::EVODEVO_FILE {
namespace {

constexpr std::uint64_t scenes = 32;
constexpr std::size_t lives_of_each = 32;

/// Calls `check(scene, lives)` for each of many random scenes.
template <class F>
void for_random_scenes(const F& check) {
  for (std::uint64_t seed = 0; seed < scenes; ++seed) {
    SCOPED_TRACE("random_scene(" + std::to_string(seed) + ")");
    const Scene scene = random_scene(seed);
    check(scene, random_lives(scene, seed, lives_of_each));
  }
}

std::string trace(const Life& life) { return "the life of seed " + std::to_string(life.seed); }

class Property : public EachWay {
 protected:
  static std::vector<Answer> ends(const Scene& scene, const std::vector<Life>& lives, Recording recording = {}) {
    return simulate(*factory()(scene), lives, recording);
  }
};

INSTANTIATE_TEST_SUITE_P(Methods, Property, all_ways(), named);

TEST_P(Property, AStepThatABodyBearsIsNeverFlaggedAndItsMirrorImageMovesAsItDoes) {
  for_random_scenes([&](const Scene& scene, const std::vector<Life>& lives) {
    std::vector<Life> images = lives;
    for (Life& life : images) life.start = mirrored(life.start);
    const std::vector<Answer> real = ends(scene, lives, {.stress = true, .work = true});
    const std::vector<Answer> image = ends(mirrored(scene), images);
    for (std::size_t i = 0; i < lives.size(); ++i) {
      SCOPED_TRACE(trace(lives[i]));
      EXPECT_EQ(real[i].task.status, Status::ok) << real[i].task.reason;
      EXPECT_TRUE(is_finite(real[i].task, real[i].state));
      EXPECT_EQ(mirrored(image[i].state).position, real[i].state.position);
      EXPECT_EQ(mirrored(image[i].state).velocity, real[i].state.velocity);
    }
  });
}

TEST_P(Property, NoPlaceIsSpecial) {
  for_random_scenes([&](const Scene& scene, const std::vector<Life>& lives) {
    const Vec3 shift{2, -1, scene.floor ? 0.0 : 3.0};
    std::vector<Life> elsewhere = lives;
    for (Life& life : elsewhere) {
      for (Vec3& x : life.start.position) x = x + shift;
      life.start.start_energy = 1 + std::max(0.0, total_energy(life.body, life.start, scene));
    }
    const std::vector<Answer> here = ends(scene, lives), there = ends(scene, elsewhere);
    // positions of a few m are rounded differently; stiff contact, and directions of springs of nearly zero length,
    // amplify this
    const double error = single() ? 5e-3 : 1e-10;
    for (std::size_t i = 0; i < lives.size(); ++i) {
      State back = there[i].state;
      for (Vec3& x : back.position) x = x - shift;
      EXPECT_LT(largest_difference(back, here[i].state), error) << trace(lives[i]);
    }
  });
}

/// Properties that need double precision, since their tolerances are tight.
class ExactProperty : public ::testing::TestWithParam<Method> {
 protected:
  static std::unique_ptr<Simulator> simulator(const Scene& scene) {
    return make_cpu_simulator(scene, {GetParam(), Precision::float64}, 1);
  }
};

INSTANTIATE_TEST_SUITE_P(Methods, ExactProperty, ::testing::ValuesIn(all_methods), named);

double total_mass(const Body& body) {
  double sum = 0;
  for (const Mass& mass : body.masses) sum += mass.mass;
  return sum;
}

/// Random lives in which no mass is held in place.
std::vector<Life> free_lives(const Scene& scene, std::uint64_t seed) {
  std::vector<Life> lives = random_lives(scene, seed, lives_of_each);
  for (Life& life : lives)
    for (Mass& mass : life.body.masses)
      if (mass.mass == 0) mass.mass = 0.1;
  return lives;
}

/// The factor by which a step with damping alone changes momentum.
double kept_by_damping(Method method, double rate_dt) {
  const double a = rate_dt;
  return method == Method::rk4 ? 1 - a + a * a / 2 - a * a * a / 6 + a * a * a * a / 24 : std::exp(-a);
}

TEST_P(ExactProperty, MomentumIsWhatGravityAndDampingLeave) {
  for (std::uint64_t seed = 0; seed < scenes; ++seed) {
    Scene scene;
    if (seed % 3 == 1) scene.gravity = Gravity{};
    if (seed % 3 == 2) scene.damping = Damping{};
    const std::vector<Life> lives = free_lives(scene, seed);
    const std::vector<Answer> answers = simulate(*simulator(scene), lives);
    for (std::size_t i = 0; i < lives.size(); ++i) {
      SCOPED_TRACE(trace(lives[i]));
      const auto& [life_seed, body, start, dt, steps, sampled_at] = lives[i];
      const Momentum before = momentum(body, start), after = momentum(body, answers[i].state);
      const auto n = static_cast<double>(steps);
      Vec3 expected = before.linear;
      if (scene.gravity) expected.z -= total_mass(body) * 9.81 * n * dt;
      if (scene.damping) expected = std::pow(kept_by_damping(GetParam(), scene.damping->rate * dt), n) * expected;
      EXPECT_LE(norm(after.linear - expected), 1e-12 * n * (before.scale + after.scale));
    }
  }
}

/// The kinetic, elastic and gravitational energy of a body, and the elastic energy of the floor, J.
double energy(const Life& life, const State& state, const Scene& scene) {
  double sum = total_energy(life.body, state, scene);
  if (scene.floor)
    for (std::size_t i = 0; i < life.body.masses.size(); ++i)
      if (life.body.masses[i].mass > 0)
        sum += 0.5 * scene.floor->stiffness * std::pow(std::min(0.0, state.position[i].z), 2);
  return sum;
}

/// The power of muscles, and the power lost by damping and drag, W.
struct Power {
  double muscles = 0, losses = 0;
};

Power power(const Life& life, const State& state, const Scene& scene) {
  Power sum;
  for (const Spring& s : life.body.springs) {
    const Material& m = life.body.materials[s.material];
    const double angle = 2 * pi * m.frequency * state.time + m.phase;
    const double pull =
        m.stiffness * (norm(state.position[s.b] - state.position[s.a]) - s.rest_length * m.relative_length(state.time));
    sum.muscles -= pull * s.rest_length * m.amplitude * 2 * pi * m.frequency * std::cos(angle);
  }
  for (std::size_t i = 0; i < life.body.masses.size(); ++i) {
    const double speed = norm(state.velocity[i]);
    if (scene.damping) sum.losses += scene.damping->rate * life.body.masses[i].mass * speed * speed;
    if (scene.drag) sum.losses += scene.drag->coefficient * speed * speed * speed;
  }
  return sum;
}

/// Compares, after each step, the energy of a life with the initial energy plus the work of muscles minus losses by
/// damping and drag. Deviations are relative to the sum of all energies.
class Balance {
 public:
  Balance(const Life& life, const Scene& scene)
      : life_(life), scene_(scene), first_(energy(life, life.start, scene)), last_(power(life, life.start, scene)) {
    for (std::size_t i = 0; i < life.start.velocity.size(); ++i)
      turnover_ += life.body.masses[i].mass * dot(life.start.velocity[i], life.start.velocity[i]) / 2;
    turnover_ += std::abs(first_) + 1e-9;  // avoids 0 if all masses are held and nothing moves
  }

  void add(const State& state) {
    const Power now = power(life_, state, scene_);
    const double given = life_.dt * (last_.muscles + now.muscles) / 2;
    const double taken = life_.dt * (last_.losses + now.losses) / 2;
    accounted_ += given - taken;
    turnover_ += std::abs(given) + taken;
    last_ = now;
    const double off = energy(life_, state, scene_) - first_ - accounted_;
    gained_ = std::max(gained_, off);
    lost_ = std::max(lost_, -off);
  }

  double gained() const { return gained_ / turnover_; }
  double lost() const { return lost_ / turnover_; }

 private:
  const Life& life_;
  const Scene& scene_;
  double first_;
  Power last_;
  double accounted_ = 0, turnover_ = 0, gained_ = 0, lost_ = 0;
};

/// The largest relative deviation of a balance if h, which is dt times the highest angular frequency, is at most 0.1.
/// Semi-implicit methods conserve a modified energy that differs by h/2, and velocity-verlet one that differs by h^2/8.
/// Other deviations are due to the quadrature in Balance, and to the sequential solution of springs in xpbd.
double most_gained(Method method) {
  if (method == Method::velocity_verlet) return 0.005;
  return method == Method::rk4 || method == Method::implicit ? 0.001 : 0.1;
}

TEST_P(ExactProperty, EnergyIsWhatMusclesAndLossesAccountFor) {
  for_random_scenes([&](const Scene& scene, std::vector<Life> lives) {
    for (Life& life : lives) life.dt /= 10;
    std::vector<Balance> balances;
    for (const Life& life : lives) balances.emplace_back(life, scene);
    std::vector<Life> now = lives;
    for (Life& life : now) life.steps = 1;
    const auto one_step = simulator(scene);
    for (std::uint64_t step = 0; step < lives.front().steps; ++step) {
      const std::vector<Answer> answers = simulate(*one_step, now);
      for (std::size_t i = 0; i < lives.size(); ++i) {
        now[i].start = answers[i].state;
        balances[i].add(now[i].start);
      }
    }
    const double most = most_gained(GetParam());
    const bool may_lose_more = scene.floor && (scene.friction || scene.floor->rigid());
    const bool only_what_is_accounted = is_explicit(GetParam()) && !may_lose_more;
    for (std::size_t i = 0; i < lives.size(); ++i) {
      EXPECT_LT(balances[i].gained(), most) << trace(lives[i]);
      if (only_what_is_accounted) {
        EXPECT_LT(balances[i].lost(), most) << trace(lives[i]);
      }
    }
  });
}

/// A mass that sinks freely reaches the height 0 after 40 of 60 steps. It bounces off a rigid floor in the step that
/// would take it below: a step earlier, it is one step's way down above the floor, and moves one step's way up more.
TEST(Sensitivity, IsTheDisplacementOfFreeMotionAndOneStepOfALanding) {
  constexpr double moved = 1e-9, speed = 1.7, restitution = 0.6;
  Life life{.body = single_mass(0.21, {0.3, -0.2, 0}), .dt = 0.00013};
  life.start = resting(life.body, {});
  life.start.position[0].z = 40 * speed * life.dt;
  life.start.velocity[0].z = -speed;
  life.start.start_energy = 1;
  const auto apart = [&](const Scene& scene) {
    return sensitivity(life, scene, {Method::symplectic_euler, Precision::float64}, moved);
  };
  EXPECT_GT(apart({}), 0.9 * moved);
  EXPECT_LT(apart({}), 1.001 * std::sqrt(3.0) * moved);
  EXPECT_NEAR(apart({{}, Floor{.restitution = restitution}, {}, {}, {}}), (1 + restitution) * speed * life.dt,
              3 * moved);
}

}  // namespace
}  // namespace evodevo::test::EVODEVO_FILE
