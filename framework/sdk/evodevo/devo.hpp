// Development: what changes in a body between two cycles of its life.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "evodevo/genome.hpp"
#include "evodevo/operator.hpp"

namespace evodevo {

/// What a devo operator has to know about every spring's last cycle; nothing else is recorded.
struct SpringRequest {
  bool stress = false;       ///< DevoContext::stress
  bool peak_force = false;   ///< DevoContext::peak_force
  bool muscle_work = false;  ///< DevoContext::muscle_work
  bool tension = false;      ///< DevoContext::tension
};

/// The context of a devo operator: what it may look at after a cycle.
struct DevoContext {
  const Body& body;
  const State& state;
  std::span<const double> stress;  ///< mean absolute force of every spring over the last cycle, N; where the
                                   ///< experiment's probe is skip-shift, how often it was its group's most
                                   ///< stressed less how often its least
  int cycle;                       ///< cycles lived so far, from 1
  int cycles;                      ///< cycles in the whole development
  int application;                 ///< how often this operator has been applied, this time included
  int applications;                ///< how often it is applied in the whole development
  double time;                     ///< since birth, s
  Box bounds;                      ///< of the body now, cut off at the floor where there is one, m
  double mass;                     ///< of a new mass, kg
  bool resets;                     ///< whether the body goes back to its rest positions before it moves on
  const Genome& genome;
  const Layout& layout;
  // like stress, empty where Devo::observes() does not ask for them; springs that came since the cycle ended carry the
  // mean of the others
  std::span<const double> peak_force = {};   ///< the largest absolute force, N
  std::span<const double> muscle_work = {};  ///< positive work of the spring's muscle on the body, J
  std::span<const double> tension = {};      ///< the mean force, N: positive where it pulled, negative where it pushed

  /// Where a mass is when life goes on, m.
  Vec3 position(std::uint32_t mass_index) const {
    return resets ? body.masses[mass_index].rest : state.position[mass_index];
  }
};

struct NewMass {
  Vec3 position;    ///< m; it starts at rest
  double mass = 0;  ///< kg
  std::int32_t material = no_material;
};

struct NewSpring {
  std::uint32_t a = 0, b = 0;
  Material material;
  std::optional<double> rest_length;  ///< m; without it, the one at which the spring is born without force
};

/// New properties of a spring that stays between its masses.
struct ChangedSpring {
  std::uint32_t spring = 0;
  std::optional<double> rest_length = {};  ///< m; without it, that of before
  std::optional<Material> material = {};   ///< without it, that of before
};

/// A part of the way that all springs go from their rest length at birth to Spring::growth times it, in a straight
/// line. By a factor, so that whatever else has changed a rest length stays.
struct Growth {
  double from = 0, to = 0;  ///< how much of the way is gone before and after, 0 to `whole`
  double whole = 1;         ///< such as the number of the operator's applications
};

/// For the record of a life: the number that led to each edit, such as the stress of the spring that goes, in the order
/// of the edits and as Devo::measure() says. A list is empty where no number did.
struct Causes {
  std::vector<double> removed_springs, removed_masses, changed_springs, new_masses, new_springs;

  using List = std::vector<double> Causes::*;
  static constexpr std::array lists{&Causes::removed_springs, &Causes::removed_masses, &Causes::changed_springs,
                                    &Causes::new_masses, &Causes::new_springs};
};

/// The changes that a devo operator requests. All indices are those of the DevoContext; the masses in `new_masses` are
/// numbered after its masses. The host applies an operator's edits together after the call. It refuses dangling
/// springs, duplicate springs, springs of air, and numbers that are not finite.
struct Edits {
  std::optional<Growth> growth;  ///< of all springs at once; a rest length among `changed_springs` takes its place
  std::vector<std::uint32_t> removed_springs;
  std::vector<std::uint32_t> removed_masses;   ///< their springs go with them
  std::vector<ChangedSpring> changed_springs;  ///< none of which goes
  std::vector<NewMass> new_masses;
  std::vector<NewSpring> new_springs;
  Causes causes;

  bool empty() const {
    return !growth && removed_springs.empty() && removed_masses.empty() && changed_springs.empty() &&
           new_masses.empty() && new_springs.empty();
  }
};

/// How many random pairs of masses to try for each new spring before a body counts as one in which all are joined.
inline constexpr std::size_t attempts_per_spring = 100;

/// What numbers are: a name, and a unit ("1" for pure numbers).
struct Measure {
  std::string name, unit;
};

class Devo : public Operator {
 public:
  static constexpr std::string_view kind = "devo";

  /// Asked once the parameters are set.
  virtual SpringRequest observes() const { return {.stress = true}; }
  /// What the causes in one of the lists are. Where the probe is skip-shift, those in N are in points.
  virtual Measure measure([[maybe_unused]] Causes::List list) const { return {"stress", "N"}; }
  /// Whether it lets springs grow, which changes nothing unless Encoding::sets_growth().
  virtual bool uses_growth() const { return false; }
  virtual void develop(const DevoContext& context, Edits& edits, Rng& rng) const = 0;
};

}  // namespace evodevo
