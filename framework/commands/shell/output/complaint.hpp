// How the program tells errors.
#pragma once

#include <functional>

namespace evodevo {

/// Does `work`, which returns an exit code. If it throws an exception, prints its message, which may have several
/// lines, on standard error and returns 2 for bad input (InputError, ConfigErrors) and 1 for anything else. On a
/// terminal, it also shows the line of the file at which a message points; other programs get the message alone.
int or_complain(const std::function<int()>& work);

}  // namespace evodevo
