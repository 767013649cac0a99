// Applies the edits of devo operators to bodies. Edits are resolved once; then they are applied, recorded, and applied
// again in re-simulations.
#pragma once

#include <memory>

#include "core/simulator.hpp"
#include "evodevo/devo.hpp"
#include "evodevo/samples.hpp"
#include "life/life_record.hpp"

namespace evodevo {

/// A body in the middle of its life, with its spring records of the last cycle.
struct LivingBody : SpringRecords {
  Body body;
  State state;
  /// [masses] time in which each mass has touched the ground, as far as it was counted, s; empty if it was not
  std::vector<double> contact_times = {};
  MassNumbers numbers = MassNumbers(0);  ///< of the masses; empty if nobody gave them numbers
  /// The body as samples show it, until it changes; null if no sample shows it.
  std::shared_ptr<const BodyVersion> version = nullptr;
  double longest_dt = 0;                                     ///< LongestStep::dt, s
  std::shared_ptr<const Preparation> preparation = nullptr;  ///< what the simulator reuses in the next cycle
};

/// Returns edits in the form in which they are applied and recorded. Removed masses and springs are in ascending order
/// without duplicates, each with its cause, and every new spring between existing masses has a rest length. If there
/// are more or fewer causes than removed items, both lists stay as they are, and apply() throws.
Edits resolved(const Edits& edits, const DevoContext& context);

/// Applies resolved edits, all of them together. New springs get the mean records of the springs that stay; new masses
/// get the next numbers, and have not touched the ground. Materials that are no longer used are removed, except the
/// base materials. Throws a std::invalid_argument that names the edit if growth goes beyond its end, an index is out of
/// range, a spring joins a mass to itself or to a removed mass, a pair of masses is joined twice, a spring is changed
/// twice or is both changed and removed, a spring is of air, a number is not finite, or there are more or fewer causes
/// than edits.
void apply(const Edits& resolved, LivingBody& living);
/// Does the same for a body alone, without its state and records.
void apply(const Edits& resolved, Body& body);

/// Makes only those spring records visible in an operator's context that the operator asked for.
void show_records(const SpringRecords& records, const SpringRequest& request, DevoContext& context);

}  // namespace evodevo
