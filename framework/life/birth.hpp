// Birth: makes lives from genomes and from bodies in files. Every life begins here.
#pragma once

#include <span>
#include <vector>

#include "life/body_building.hpp"
#include "life/life.hpp"
#include "life/life_simulation.hpp"

namespace evodevo {

/// Returns the blueprint that the experiment's encoding makes from a genome. Throws a std::runtime_error that
/// names the encoding if the encoding throws or the blueprint is malformed (check_blueprint()).
Blueprint decoded(const Experiment& experiment, const Genome& genome, CallSubject subject = {});

/// Builds the body of a blueprint that decoded() has returned. Throws a std::runtime_error that names the encoding if
/// it throws when it completes the blueprint.
BuiltBody build_body(const Experiment& experiment, Blueprint blueprint, CallSubject subject = {});

/// Makes lives from genomes or bodies. It builds each body, adds the scene's payload, puts the body on the ground and
/// chooses its time step. Operators remember what the encoding gives the masses to remember, or 0. The life of a body
/// that cannot be built or simulated ends as invalid. Experiment and simulation must outlive this object and the lives.
class Birth {
 public:
  Birth(const Experiment& experiment, const LifeSimulation& simulation);

  /// Only decodes genomes and builds bodies, without a payload, a state or a time step. If newborns that follow each
  /// other have one genome in common, it is decoded once.
  std::vector<BuiltBody> build(std::span<const Newborn> newborns) const;
  /// Returns the lives of newborns, one for each, in the same order. They begin in the scene of a scenario, or in that
  /// of the experiment. In a scenario, operators develop them even if a newborn comes with a record, because records
  /// are of lives in the experiment's scene.
  std::vector<Life> of(std::span<const Newborn> newborns, const Scenario* scenario = nullptr) const;
  /// Returns the lives of newborns in each scene in which they develop.
  Cohort in_all_scenes(std::span<const Newborn> newborns) const;
  /// Returns the life of a body that no genome of the experiment describes, such as one from a file.
  Life of(Body body) const;
  /// Returns the life of a body in the middle of its life, in the given state. The life ends as invalid if the body is
  /// so deep in the floor that the floor would fling it out.
  Life amid_life(Body body, State state) const;

  double seconds() const { return clock_.seconds(); }  ///< wall-clock time spent on making bodies from genomes, s

 private:
  std::vector<Life> begin_all(std::vector<BuiltBody> built, std::span<const Newborn> newborns,
                              const Scenario* scenario) const;
  /// Moves the masses of a newborn body at random, and puts it on the ground again.
  void add_noise(Life& life) const;
  Life begin(BuiltBody built, const Scene& scene, const std::optional<Payload>& payload) const;
  /// Returns the life of a body in the given state, for which no time step has been chosen yet.
  Life life_of(BuiltBody built, State state, const Scene& scene) const;

  const Experiment& experiment_;
  const LifeSimulation& simulation_;
  std::vector<MemoryNames> names_;  ///< of what each devo operator remembers
  mutable BusyClock clock_;
};

/// Moves each mass along each axis by up to `most` metres at random: by its identity if draws are inherited, otherwise
/// one mass after the other from `rng`.
void move_at_random(double most, const Draws& draws, Rng rng, LivingBody& living);

/// A small perturbation of a body: the largest offset of a mass along each axis, relative to the body's longest
/// side, 1.
inline constexpr double perturbation = 1e-4;
/// Returns the conditions of lives to come, which differ from those seen even if the experiment has no birth noise:
/// then the masses of newborns are moved by `perturbation`.
Conditions conditions_to_come(const Experiment& experiment);
/// Perturbs a body: moves each mass along each axis at random by up to `perturbation` of the body's longest side.
/// `start` (below 240) selects the RNG stream.
void perturb(Life& life, const Experiment& experiment, std::uint32_t start);

}  // namespace evodevo
