// The file descriptors 0, 1 and 2.
#pragma once

namespace evodevo {

/// Opens /dev/null in place of each standard stream that this process was started without, so that no file or pipe gets
/// the number of one and what is said to the user into it. Input is then at its end; writing output fails, as on a full
/// disk; error messages are dropped. To be called before anything is opened.
void open_standard_streams();

}  // namespace evodevo
