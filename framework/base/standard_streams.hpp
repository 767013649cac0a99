// Standard input, output and error: the file descriptors 0, 1 and 2.
#pragma once

namespace evodevo {

/// Opens /dev/null for each standard stream that was closed when this process started. Otherwise a file opened later
/// would get the descriptor of that stream, and messages to the user would be written into the file. Reading from a
/// standard input opened in this way reports the end of the file at once, writing to such a standard output fails, and
/// error messages are discarded. To be called before the program opens any file.
void open_standard_streams();

}  // namespace evodevo
