// Small helpers for messages.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "evodevo/parameters.hpp"

namespace evodevo {

/// How the user calls this program, for remedies that can be pasted: "evodevo", or what the launching script says.
std::string program_name();

/// A decimal text that reads back as the same number, with no more digits than that takes.
std::string to_text(double value);

/// "0 to 1" or "at least 0", without the unit; empty where everything is allowed.
std::string to_text(const Range& range);

/// "a, b, c".
std::string joined(std::span<const std::string> items, std::string_view separator = ", ");

/// Puts `value` in the place of every `mark`.
void replace_all(std::string& text, std::string_view mark, std::string_view value);

/// The candidate that `word` was probably meant to be; empty if none is near.
std::string nearest(std::string_view word, std::span<const std::string> candidates);

/// `; did you mean "x"?` for the nearest candidate, or `; known: a, b, c` where none is near or there are only few.
std::string suggestion(std::string_view word, std::span<const std::string> candidates);

}  // namespace evodevo
