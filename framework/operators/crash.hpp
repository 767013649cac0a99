// Ends of the process in an operator's code, which are named before.
#pragma once

namespace evodevo {

/// From now on a signal that ends the process in an operator's code names the call on stderr first; stacks that
/// overflow are told apart. An operator that ends the process by exit() is named likewise, and the exit code is 1.
void name_crashing_operators();
/// Signals and exit() do again what they do by default.
void leave_crashes_unnamed();

}  // namespace evodevo
