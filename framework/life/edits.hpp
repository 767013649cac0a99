// What devo operators want changed: resolved once, then applied, recorded and applied again.
#pragma once

#include <memory>

#include "core/simulator.hpp"
#include "evodevo/devo.hpp"

namespace evodevo {

/// A body in the middle of its life. The records are of the last cycle.
struct LivingBody : SpringRecords {
  Body body;
  State state;
  double longest_dt = 0;                                     ///< see LongestStep, s
  std::shared_ptr<const Preparation> preparation = nullptr;  ///< what the simulator keeps from cycle to cycle
};

/// What an operator's edits come down to: the form that is applied, recorded and applied again. What goes stands in
/// ascending order and once, with its cause, and every new spring between masses that there are has its rest length.
/// Causes that are not as many as their edits stay as they are, to be refused by apply().
Edits resolved(const Edits& edits, const DevoContext& context);

/// Applies resolved edits, all of them together. New springs carry the mean records of the old ones, and materials that
/// nothing is made of any more go. Throws std::invalid_argument, naming the edit, for growth beyond its way, an index
/// out of range, a mass joined to itself or to one that goes, a pair joined twice, a spring changed twice or one that
/// goes, air, a number that is not finite, or more or fewer causes than edits.
void apply(const Edits& resolved, LivingBody& living);
/// The same to a body alone, whose motion is of no interest.
void apply(const Edits& resolved, Body& body);

/// Lets an operator's context show what the operator asked for of the springs, and no more.
void show_records(const SpringRecords& records, const SpringRequest& request, DevoContext& context);

}  // namespace evodevo
