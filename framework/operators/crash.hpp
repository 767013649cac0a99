// Reports which operator crashed the process or made it exit.
#pragma once

namespace evodevo {

/// Makes the process report crashes of operators. If a fatal signal occurs in an operator's code, a message on stderr
/// names the call, and says whether its stack overflowed, before the process ends. If an operator calls exit(), a
/// message names the call as well, and the exit code is 1.
void name_crashing_operators();
/// Restores the default behaviour of fatal signals and of exit().
void leave_crashes_unnamed();

}  // namespace evodevo
