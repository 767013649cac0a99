// From genomes and files to bodies that live: the one way in which a life begins.
#pragma once

#include <span>
#include <vector>

#include "life/body_building.hpp"
#include "life/life.hpp"
#include "life/life_simulation.hpp"

namespace evodevo {

/// What the experiment's encoding makes of a genome. Blames the encoding for what cannot be a blueprint.
Blueprint decoded(const Experiment& experiment, const Genome& genome, CallSubject subject = {});

/// Genomes or bodies go in; lives that are about to move come out: each body built, with the scene's payload, on the
/// scene's ground, with the step that it bears. A body that cannot live comes out as invalid. Experiment and simulation
/// must outlive it.
class Birth {
 public:
  Birth(const Experiment& experiment, const LifeSimulation& simulation)
      : experiment_(experiment), simulation_(simulation) {}

  /// Only decodes: the bodies before the scene has them.
  std::vector<BuiltBody> build(std::span<const Newborn> newborns) const;
  /// The lives of newborns, in their order.
  std::vector<Life> of(std::span<const Newborn> newborns) const;
  /// The life of a body from elsewhere.
  Life of(Body body) const;
  /// A body in the middle of its life, as it is. It is invalid where the ground would throw it out.
  Life amid_life(Body body, State state) const;

  double seconds() const { return clock_.seconds(); }  ///< in which genomes were decoded

 private:
  const Experiment& experiment_;
  const LifeSimulation& simulation_;
  mutable BusyClock clock_;
};

/// Moves each mass along each axis at random by up to 1e-4 of the body's longest side, so that starts differ by noise.
/// `start` (below 240) selects the stream of random numbers.
void perturb(Life& life, const Experiment& experiment, std::uint32_t start);

}  // namespace evodevo
