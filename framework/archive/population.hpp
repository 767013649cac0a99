// The individuals of a run, and the summary of a generation.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "life/evaluation.hpp"

namespace evodevo {

/// An individual of another population.
struct Migrated {
  std::int64_t island = 0;       ///< number of the island, from 1; 0: of the run that `[experiment] start` names
  std::uint32_t individual = 0;  ///< id on that island or in that run

  bool operator==(const Migrated&) const = default;
};

/// An individual on its way to another population. There it is born again, as a newborn with the same genome.
struct Migrant {
  Migrated from;
  std::uint32_t origin = 0;  ///< Individual::origin, which is the same on all islands
  Genome genome;
};

/// An individual that has left for another island. It also stays where it is.
struct Emigration {
  std::int64_t island = 0;  ///< number of the island that it goes to
  std::uint32_t individual = 0;
};

struct Individual {
  std::uint32_t id = 0;      ///< consecutive number from 0, in the order of birth
  std::uint32_t born = 0;    ///< generation in which the individual was born
  std::uint32_t origin = 0;  ///< generation in which its oldest genes were drawn or sampled; its age counts from then
  std::vector<std::uint32_t>
      parents;          ///< ids of the parent, which it may replace, and the mate, as far as there are any
  std::string made_by;  ///< names of the variation operators that made it, joined by '+', name of the selection
                        ///< operator that made it, "random", "migration", or "start"
  Genome genome;
  Result result;
  std::uint32_t lives = 1;                ///< number of lives that it has had
  std::uint32_t measured = 0;             ///< generation in which the last of them were evaluated
  std::uint32_t provenance = 0;           ///< of the result: index into Archive::provenances()
  std::optional<Migrated> migrated = {};  ///< of an immigrant or a founder: where it comes from

  std::uint32_t age(std::uint32_t generation) const { return generation - origin; }
};

/// Returns an individual as a newborn that is born again to all the lives that it has had.
Newborn newborn_of(const Individual& individual);

/// Returns the indices of those individuals that have a fitness, the best first objective first; ties are in their
/// order.
std::vector<std::size_t> fittest_first(const std::vector<Individual>& individuals, bool maximise);

/// The summary of one generation.
struct Summary {
  std::uint32_t generation = 0;
  std::int64_t evaluations = 0;            ///< number of evaluations since the run began
  std::optional<double> best, median;      ///< of the first objective, over the survivors whose status is `ok`
  std::int64_t diverged = 0, invalid = 0;  ///< numbers of newborns, and of elders that lived again, with this status
  /// Numbers of individuals that got this status in this generation.
  std::int64_t artefact = 0, lucky = 0, passive = 0;
  std::int64_t refused() const { return artefact + lucky + passive; }
  std::int64_t clones = 0;  ///< newborns genetically equal to a member of the population or to an earlier newborn
  std::uint64_t spring_evaluations = 0;  ///< spring evaluations of this generation
  double wall_time = 0;                  ///< wall-clock time of this generation, s
};

/// What verification found of an individual whose fitness does not hold.
struct Refusal {
  std::uint32_t individual = 0;
  Status status = Status::artefact;  ///< artefact, lucky or passive
  std::string reason;                ///< the trial, and the fitness in it and in the run
};

/// A number that a selection operator has noted about an individual.
struct NoteOf {
  std::uint32_t individual = 0;
  std::uint32_t title = 0;  ///< index into Experiment::note_titles()
  double value = 0;
};

/// What the selection operators remember.
struct Memories {
  SelectionMemory survivors;  ///< of Experiment::selection
  SelectionMemory parents;    ///< of Experiment::parent_selection; empty if there is none
};

/// What the selection operators leave behind in a generation besides newborns and survivors.
struct Remembered {
  Memories memory;
  std::vector<NoteOf> notes;  ///< at most one of each title about an individual
};

}  // namespace evodevo
