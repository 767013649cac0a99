#include "archive/population.hpp"

#include <algorithm>
#include <functional>

namespace evodevo {

Newborn newborn_of(const Individual& individual) {
  return {.id = individual.id, .generation = individual.born, .genome = &individual.genome, .lives = individual.lives};
}

std::vector<std::size_t> fittest_first(const std::vector<Individual>& individuals, bool maximise) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < individuals.size(); ++i)
    if (individuals[i].result.status == Status::ok) order.push_back(i);
  const double sign = maximise ? 1 : -1;
  std::ranges::stable_sort(order, std::greater(),
                           [&](std::size_t i) { return sign * individuals[i].result.objectives.front(); });
  return order;
}

}  // namespace evodevo
