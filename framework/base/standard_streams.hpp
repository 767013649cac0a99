// Standard input, output and error: the file descriptors 0, 1 and 2.
#pragma once

namespace evodevo {

/// Opens /dev/null for each standard stream that was closed when this process started. Otherwise a file opened later
/// would get that descriptor, and messages to the user would be written into it. Reading from such an input finds its
/// end at once, writing to such an output fails, and error messages are dropped. To be called before the program opens
/// any file.
void open_standard_streams();

}  // namespace evodevo
