#include "life/life.hpp"

#include "base/philox.hpp"

namespace evodevo {

Draws draws_for(const Experiment& experiment, const Newborn& newborn, std::string_view what, std::uint64_t number) {
  const bool inherited = experiment.development.draws == DrawsBy::inherited;
  const std::uint64_t origin = Tag(what, number).key;
  if (inherited) {
    const std::uint64_t key = mixed(origin, static_cast<std::uint64_t>(experiment.development.seed));
    return {philox, newborn.life > 0 ? mixed(key, newborn.life) : key, origin, true};
  }
  const std::uint64_t of_run = mixed(origin, static_cast<std::uint64_t>(experiment.seed));
  return {philox, mixed(mixed(of_run, newborn.generation), newborn.id), origin, false};
}

}  // namespace evodevo
