#include "conformance/behaviours.hpp"

#include <limits>

#include "base/philox.hpp"
#include "life/measurement/windows.hpp"

namespace evodevo::conformance {
namespace {

constexpr std::uint32_t corners = 8;  // of a cube

/// The masses of a cube, with a spring from each to every other.
BodyVersion cube() {
  BodyVersion version;
  Body& body = version.body;
  body.materials = {{1000, 0, 0, 0}, {1000, 0.1, 1, 0}};
  for (std::uint32_t i = 0; i < corners; ++i) {
    body.masses.push_back({{(i & 1) * 0.5, (i >> 1 & 1) * 0.5, (i >> 2 & 1) * 0.5}, 0.2});
    version.numbers.push_back(i);
    for (std::uint32_t other = 0; other < i; ++other) {
      const double length = norm(body.masses[i].rest - body.masses[other].rest);
      body.springs.push_back({other, i, length, (i + other) % 2, 1, length});
    }
  }
  return version;
}

}  // namespace

SampleBehaviour sample_behaviour(const Request& request, std::uint64_t seed, std::uint32_t input, Vec3 place) {
  Rng rng(philox, {seed, input, 0, 0});
  const auto position = [&] { return place + Vec3{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(0, 1)}; };
  const Vec3 low = position(), size = position() - place + Vec3{2, 2, 1};
  SampleBehaviour behaviour;
  Observation& seen = behaviour.observation;
  seen.box = {low, low + size};
  seen.centre_before = low + 0.5 * size;
  seen.centre_after = position();
  seen.window = request.window;
  const double work = rng.uniform(0, 50);
  if (request.work) seen.work = work;
  behaviour.version = std::make_shared<const BodyVersion>(cube());
  const Body& body = behaviour.version->body;
  if (!request.cycle) seen.body = &body;
  if (!(request.rate > 0)) return behaviour;

  // the body moves evenly from the first place to the last one, and shakes
  const auto last = static_cast<double>(last_sample(request));
  std::vector<double> contact_times(corners, 0.0);
  double contact_time = 0;
  for (double i = 0; i <= last; ++i) {
    const double share = last > 0 ? i / last : 0;
    StoredSample& sample = behaviour.samples.emplace_back(StoredSample{.time = 5 + i / request.rate});
    const auto touched = [&] { return i > 0 ? rng.uniform(0.2, 0.8) / request.rate : 0; };
    const Vec3 moved = share * (seen.centre_after - seen.centre_before);
    sample.centre = seen.centre_before + moved;
    sample.velocity = (1 / request.window) * (seen.centre_after - seen.centre_before);
    sample.box = {low + moved, low + moved + size};
    sample.contact_time = contact_time += touched();
    sample.work = share * work;
    sample.version = behaviour.version;
    for (const Mass& mass : body.masses) {
      const Vec3 at = sample.centre + mass.rest;
      for (const double number : {at.x, at.y, at.z}) sample.positions.push_back(static_cast<float>(number));
      for (int c = 0; c < 3; ++c) sample.velocities.push_back(static_cast<float>(rng.uniform(-1, 1)));
    }
    for (double& time : contact_times) sample.contact_times.push_back(time += touched());
    for (std::size_t s = 0; s < body.springs.size(); ++s)
      sample.forces.push_back(static_cast<float>(rng.uniform(-100, 100)));
  }
  std::vector<const StoredSample*> samples;
  for (const StoredSample& sample : behaviour.samples) samples.push_back(&sample);
  seen.samples = Samples(std::move(samples), request.channels);
  return behaviour;
}

SampleBehaviour unmeasurable_behaviour(const Request& request) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  SampleBehaviour behaviour = sample_behaviour(request, 0, 0, {nan, nan, nan});
  Observation& seen = behaviour.observation;
  seen.box = {{nan, nan, nan}, {nan, nan, nan}};
  if (request.work) seen.work = nan;
  for (StoredSample& sample : behaviour.samples) {
    sample.velocity = {nan, nan, nan};
    sample.contact_time = sample.work = nan;
    for (auto* list : {&sample.velocities, &sample.forces})
      for (float& number : *list) number = static_cast<float>(nan);
    for (double& time : sample.contact_times) time = nan;
  }
  return behaviour;
}

}  // namespace evodevo::conformance
