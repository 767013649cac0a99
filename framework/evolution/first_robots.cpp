#include "evolution/first_robots.hpp"

#include <algorithm>

#include "base/text.hpp"
#include "evolution/breeding.hpp"
#include "life/birth.hpp"

namespace evodevo {
namespace {

constexpr std::int64_t most = 10;
constexpr double most_lost = 0.2;  ///< share of the masses, which random bodies seldom lose

bool has_muscle(const Body& body) {
  return std::ranges::any_of(body.springs, [&](const Spring& spring) {
    const Material& material = body.materials.at(spring.material);
    return material.amplitude > 0 && material.frequency > 0;
  });
}

}  // namespace

FirstRobots first_robots(const Experiment& experiment) {
  FirstRobots robots;
  const auto count = static_cast<std::size_t>(std::min({most, experiment.births(0), experiment.evaluations}));
  std::string failure;
  std::size_t bodies = 0, with_muscles = 0, masses = 0, lost = 0;
  for (const Individual& robot : breed(experiment, {}, 0, 0, count)) {
    const BuiltBody built =
        build_body(experiment, decoded(experiment, robot.genome, {.individual = robot.id}), {.individual = robot.id});
    if (!built.failure.empty()) {
      failure = built.failure;
      continue;
    }
    ++bodies;
    masses += built.kept.size() + built.in_other_pieces;
    lost += built.in_other_pieces;
    with_muscles += has_muscle(built.body);
    if (const double length = bounding_box(rest_positions(built.body)).longest_side(); length > 0)
      robots.lengths.push_back(length);
  }
  std::ranges::sort(robots.lengths);
  const std::string none = "none of the first " + std::to_string(count) + " random robots ";
  if (bodies == 0)
    robots.warnings.push_back(none + "can live: " + failure + "; correct [encoding]");
  else if (with_muscles == 0)
    robots.warnings.push_back(none +
                              "has a muscle at birth; give the encoding a material whose amplitude and frequency "
                              "are above 0, unless robots get muscles later");
  if (static_cast<double>(lost) > most_lost * static_cast<double>(masses))
    robots.warnings.push_back("of the first " + std::to_string(count) + " random robots, " +
                              std::to_string(100 * lost / masses) +
                              " % of the masses are left out, because no springs join them to the largest piece; let "
                              "the encoding join more neighbours, or check the shape");
  return robots;
}

}  // namespace evodevo
