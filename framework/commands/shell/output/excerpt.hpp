// The line of a file at which an error message points.
#pragma once

#include <string>

namespace evodevo {

/// If a message begins with FILE:LINE:COLUMN: and the file has that line, returns the line and, below it, a caret under
/// the column (counted in characters from 1); otherwise an empty text. Each of the two lines ends with a line break.
std::string excerpt_for(const std::string& message);

}  // namespace evodevo
