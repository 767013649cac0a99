// Applies what devo operators want changed.
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

/// Applies one operator's edits, all of them together. `now` is the moment that the operator saw; it refers to
/// `living`. New springs carry the mean records of the old ones, and materials that nothing is made of any more go.
/// Throws std::invalid_argument, naming the edit, for growth beyond its way, an index out of range, a mass joined to
/// itself or to one that goes, a pair joined twice, a spring changed twice or one that goes, air, a number that is not
/// finite, or more or fewer causes than edits.
void apply_edits(LivingBody& living, const Edits& edits, const Moment& now);

/// Lets a moment show what was asked for of the springs, and no more.
void show_records(const SpringRecords& records, const SpringRequest& request, Moment& now);

}  // namespace evodevo
