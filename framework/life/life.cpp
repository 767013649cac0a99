#include "life/life.hpp"

#include "base/philox.hpp"

namespace evodevo {
namespace {

Draws draws_in(std::uint32_t repetition, const Experiment& experiment, const Newborn& newborn, std::string_view what,
               std::uint64_t number) {
  const bool inherited = experiment.development.draws == DrawsBy::inherited;
  const std::uint64_t origin = Tag(what, number).key,
                      seed = seed_of(inherited ? experiment.development.seed : experiment.seed, repetition),
                      key = mixed(origin, seed);
  return {philox, inherited ? key : mixed(mixed(key, newborn.generation), newborn.id), origin, inherited};
}

}  // namespace

std::uint64_t seed_of(std::int64_t seed, std::uint32_t repetition) {
  const auto own = static_cast<std::uint64_t>(seed);
  return repetition == 1 ? own : mixed(own, repetition);
}

std::vector<Newborn> each_life(const Experiment& experiment, std::span<const Newborn> newborns) {
  const bool always = experiment.development.draws_between_lives == DrawsBetweenLives::anew;
  std::vector<Newborn> all;
  for (const Newborn& newborn : newborns)
    for (std::uint32_t i = 0; i < newborn.lives; ++i) {
      const std::uint32_t life = newborn.life + i;
      const bool anew = always || newborn.redrawn;
      Newborn& one = all.emplace_back(Newborn{.id = newborn.id,
                                              .generation = newborn.generation,
                                              .genome = newborn.genome,
                                              .recorded_in = newborn.recorded_in,
                                              .life = life,
                                              .draws = anew ? life : 1,
                                              .redrawn = newborn.redrawn});
      if (i < newborn.records.size()) one.records = {newborn.records[i]};
    }
  return all;
}

Draws draws_of_development(const Experiment& experiment, const Newborn& newborn, std::string_view what,
                           std::uint64_t number) {
  return draws_in(newborn.draws, experiment, newborn, what, number);
}

Draws draws_of_life(const Experiment& experiment, const Newborn& newborn, std::string_view what, std::uint64_t number) {
  return draws_in(newborn.life, experiment, newborn, what, number);
}

}  // namespace evodevo
