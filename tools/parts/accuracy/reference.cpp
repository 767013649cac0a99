#include "reference.hpp"

#include <algorithm>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace evodevo::tools::accuracy {
namespace {

/// The right-hand side of the equations of motion. The vector y holds all positions and then all velocities, with three
/// numbers for each mass.
class EquationOfMotion {
 public:
  EquationOfMotion(const Body& body, const Scene& scene) : body_(body), scene_(scene) {}

  void operator()(const std::vector<double>& y, std::vector<double>& rate, double t) const {
    const std::size_t half = y.size() / 2;
    std::fill(rate.begin() + static_cast<std::ptrdiff_t>(half), rate.end(), 0.0);
    for (const Spring& spring : body_.springs) add_spring(spring, y, rate, t);
    for (std::size_t i = 0; i < body_.masses.size(); ++i) {
      const double mass = body_.masses[i].mass;
      const std::size_t x = 3 * i, v = half + 3 * i;
      for (std::size_t c = 0; c < 3; ++c) rate[x + c] = y[v + c];
      if (mass > 0)
        add_world(mass, y[x + 2], &y[v], &rate[v]);
      else
        std::fill_n(&rate[v], 3, 0.0);  // a mass of 0 kg is held in place
    }
  }

 private:
  void add_spring(const Spring& spring, const std::vector<double>& y, std::vector<double>& rate, double t) const {
    constexpr double full_turn = 2 * 3.14159265358979323846;
    const Material& m = body_.materials[spring.material];
    const std::size_t a = std::size_t{3} * spring.a, b = std::size_t{3} * spring.b, half = y.size() / 2;
    const double d[] = {y[b] - y[a], y[b + 1] - y[a + 1], y[b + 2] - y[a + 2]};
    const double distance = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    const double length = spring.rest_length * (1 + m.amplitude * std::sin(full_turn * m.frequency * t + m.phase));
    double lengthening = 0;  // m/s
    for (std::size_t c = 0; c < 3; ++c) lengthening += (y[half + b + c] - y[half + a + c]) * d[c] / distance;
    const double tension = body_.stiffness(spring) * (distance - length) + body_.damping(spring) * lengthening;
    for (std::size_t c = 0; c < 3; ++c) {
      const double force = tension * d[c] / distance;
      rate[half + a + c] += force / body_.masses[spring.a].mass;
      rate[half + b + c] -= force / body_.masses[spring.b].mass;
    }
  }

  /// Adds the acceleration by gravity, floor, damping and drag of a mass at the height z with the velocity v.
  void add_world(double mass, double z, const double* v, double* rate) const {
    const double speed = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    const double drag = scene_.drag ? scene_.drag->coefficient * speed / mass : 0;
    const double damping = scene_.damping ? scene_.damping->rate : 0;
    for (std::size_t c = 0; c < 3; ++c) rate[c] -= (drag + damping) * v[c];
    if (scene_.gravity) {
      const double angle = scene_.gravity->slope * (std::numbers::pi / 180);
      rate[0] += scene_.gravity->acceleration * std::sin(angle);
      rate[2] -= scene_.gravity->acceleration * std::cos(angle);
    }
    if (scene_.floor) rate[2] += scene_.floor->stiffness * std::max(0.0, -z) / mass;
  }

  const Body& body_;
  const Scene& scene_;
};

}  // namespace

State solution(const Body& body, const State& start, const Scene& scene, double time) {
  namespace odeint = boost::numeric::odeint;
  if (scene.friction) throw std::invalid_argument("Coulomb friction is no force law that could be integrated");
  if (scene.floor && scene.floor->rough()) throw std::invalid_argument("rough ground is not in the reference");
  std::vector<double> y;
  for (const auto* vectors : {&start.position, &start.velocity})
    for (const Vec3& v : *vectors) y.insert(y.end(), {v.x, v.y, v.z});
  const auto stepper = odeint::make_controlled<odeint::runge_kutta_dopri5<std::vector<double>>>(1e-13, 1e-13);
  odeint::integrate_adaptive(stepper, EquationOfMotion(body, scene), y, 0.0, time, 1e-4);
  State end = start;
  const double* next = y.data();
  for (auto* vectors : {&end.position, &end.velocity})
    for (Vec3& v : *vectors) v = {next[0], next[1], next[2]}, next += 3;
  return end;
}

double largest_distance(const State& a, const State& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.position.size(); ++i) largest = std::max(largest, norm(a.position[i] - b.position[i]));
  return largest;
}

}  // namespace evodevo::tools::accuracy
