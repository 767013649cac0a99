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

/// `text` for a message, a table or a log, none of whose lines or terminals it may break: control characters, and those
/// that turn the direction of writing, become escapes such as \n and \x1b, as do bytes that are not UTF-8. What is
/// longer than `most` bytes ends with "...". All other UTF-8 stays whole.
std::string printable(std::string_view text, std::size_t most = 300);

/// Why `text` can be no name, or another text that is printed and recorded as it is: a sentence that begins with the
/// text; empty where printable() changes nothing.
std::string text_fault(std::string_view text, std::size_t most = 300);

/// A decimal text that reads back as the same number, with no more digits than that takes; "not a number", "infinity"
/// and "-infinity" for what has none.
std::string to_text(double value);

/// Four digits, for those who only look: "0.1234", "1.2e+08"; what is not finite in the words of to_text().
std::string short_number(double value);

/// "0 to 1", "at least 0" or "at most 1", without the unit; empty where everything is allowed.
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
