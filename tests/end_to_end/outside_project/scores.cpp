// How high the centre of mass rises, how regular a gait is, and a limit of a robot's weight.
#include <algorithm>
#include <cmath>

#include "evodevo/plugin.hpp"

namespace {

class Leap final : public evodevo::Fitness {
 public:
  evodevo::Request observes() const override {
    return {.settle = 0.5, .window = 1, .rate = 50, .channels = {.centre = true}};
  }
  std::vector<evodevo::Objective> objectives() const override { return {{"leap", "m"}}; }

  std::vector<double> score(const evodevo::Observation& seen) const override {
    double highest = seen.centre_before.z;
    for (std::size_t i = 0; i < seen.samples.size(); ++i) highest = std::max(highest, seen.samples.centre(i).z);
    return {highest - seen.centre_before.z};
  }
};

/// The share of the variance of the springs' forces that lies at one frequency, on average over all springs whose force
/// varies. It is 1 if every force is a sine of this frequency.
class Gait final : public evodevo::Fitness {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.real(frequency_, "frequency", {0.1, 10, "Hz"}, "Frequency of the gait.");
  }

  evodevo::Request observes() const override {
    return {.settle = 0.5, .window = 1, .rate = 40, .channels = {.forces = true}};
  }

  std::vector<evodevo::Objective> objectives() const override {
    return {{"regularity", "1", true, evodevo::Role::measure}};
  }

  std::vector<double> score(const evodevo::Observation& seen) const override {
    double sum = 0, springs = 0;
    for (std::size_t spring = 0; spring < seen.body->springs.size(); ++spring) {
      const double share = regularity(seen.samples, spring);
      if (share == 0) continue;
      sum += share;
      springs += 1;
    }
    return {springs > 0 ? sum / springs : 0};
  }

 private:
  double regularity(const evodevo::Samples& samples, std::size_t spring) const {
    const std::size_t count = samples.size() - 1;  // whole periods without the last sample
    double mean = 0, variance = 0, sine = 0, cosine = 0;
    for (std::size_t i = 0; i < count; ++i) mean += samples.force(i, spring) / static_cast<double>(count);
    for (std::size_t i = 0; i < count; ++i) {
      const double force = samples.force(i, spring) - mean, angle = 2 * 3.14159265358979 * frequency_ * samples.time(i);
      variance += force * force;
      sine += force * std::sin(angle);
      cosine += force * std::cos(angle);
    }
    if (variance == 0) return 0;
    return 2 * (sine * sine + cosine * cosine) / (static_cast<double>(count) * variance);
  }

  double frequency_ = 1;
};

/// Robots must not be too heavy.
class Weight final : public evodevo::Fitness {
 public:
  void parameters(evodevo::Parameters& p) override {
    p.real(most_, "most", {0, 1e6, "kg"}, "Largest weight of a robot that is feasible.");
  }

  evodevo::Request observes() const override { return {.settle = 0, .window = 0.5}; }

  std::vector<evodevo::Objective> objectives() const override {
    return {{"overweight", "kg", true, evodevo::Role::constraint}};
  }

  std::vector<double> score(const evodevo::Observation& seen) const override {
    double weight = 0;
    for (const evodevo::Mass& mass : seen.body->masses) weight += mass.mass;
    return {weight - most_};
  }

 private:
  double most_ = 5;
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Leap>("outside.leap", "The height that the centre gains."),
               evodevo::operator_entry<Gait>("outside.gait", "The share of the forces' variance at one frequency."),
               evodevo::operator_entry<Weight>("outside.weight", "How much too heavy a robot is."))
