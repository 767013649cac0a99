// Applies the edits of devo operators to bodies. Edits are resolved once; then they are applied, recorded, and applied
// again in re-simulations.
#pragma once

#include <memory>

#include "core/simulator.hpp"
#include "evodevo/devo.hpp"
#include "evodevo/samples.hpp"
#include "life/experience.hpp"
#include "life/life_record.hpp"

namespace evodevo {

/// A body in the middle of its life, with its records of the last cycle.
struct LivingBody : SpringRecords, MassRecords {
  Body body;
  State state;
  /// [masses] time in which each mass has touched the ground, as far as it was counted, s; empty if it was not
  std::vector<double> contact_times = {};
  /// [masses] number of cycles that each mass has lived through; empty if no operator asks for it
  std::vector<double> cycles_lived = {};
  std::vector<OperatorMemory> memory = {};  ///< of each of the experiment's devo operators
  MassNumbers numbers = MassNumbers(0);     ///< of the masses; empty if nobody gave them numbers
  /// The body as samples show it, until it changes; null if no sample shows it.
  std::shared_ptr<const BodyVersion> version = nullptr;
  double longest_dt = 0;                                     ///< LongestStep::dt, s
  std::shared_ptr<const Preparation> preparation = nullptr;  ///< what the simulator reuses in the next cycle
  std::shared_ptr<SplitBody> split = nullptr;                ///< likewise
};

/// Returns edits in the form in which they are applied and recorded. Removed masses and springs are in ascending order
/// without duplicates, every new spring between existing masses has a rest length, and every new mass has its kilograms
/// and an identity.
Edits resolved(const Edits& edits, const DevoContext& context);

/// Whether edits change nothing but rest lengths, by one rule.
inline bool only_scales(const Edits& edits) {
  return edits.scaling && edits.removed_springs.empty() && edits.removed_masses.empty() &&
         edits.changed_springs.empty() && edits.new_masses.empty() && edits.new_springs.empty();
}

/// Replaces Edits::scaling by changes of single springs, which a record can repeat without what the operator remembers
/// now, `memory`.
void write_out_scaling(Edits& edits, const Body& body, const ItemMemory& memory);

/// Applies resolved edits of the devo operator with index `op`, all of them together. New springs get the mean records
/// of the springs that stay; new masses get the next numbers, and their records are 0. What operators remember follows
/// the edits, and is 0 for new masses and springs unless remember() has given more or a new spring is like another one.
/// Materials that are no longer used are removed, except the base materials. Throws a std::invalid_argument that names
/// the edit if a scaling goes beyond its end or by a number that the operator does not remember, an index is out of
/// range, a spring joins a mass to itself or to a removed mass, a pair of masses is joined twice, a spring is changed
/// twice or is both changed and removed, a spring is of air, a mass descends from one that does not exist, or a number
/// is not finite.
void apply(const Edits& resolved, LivingBody& living, std::optional<std::uint32_t> op = std::nullopt);

}  // namespace evodevo
