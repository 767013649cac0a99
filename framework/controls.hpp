// Controls: what a developing body is compared with.
#pragma once

#include "evodevo/devo.hpp"

namespace evodevo {

/// As many changes as `edits` holds, but each at a random place: other springs and masses go, springs of the same
/// material change by the same factors, new springs of the same materials join random masses that stay and are not yet
/// joined, and new masses come anywhere in the bounds. New springs are born without force. Fewer come where the body
/// has no room for more. Bounds that an operator keeps do not hold for what moves.
Edits at_random_places(const Edits& edits, const Moment& now, Rng& rng);

}  // namespace evodevo
