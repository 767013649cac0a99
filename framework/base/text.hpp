// Functions that format texts for messages.
#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "evodevo/parameters.hpp"

namespace evodevo {

/// The command that starts this program, for remedies that users can paste into a shell: the environment variable
/// EVODEVO_COMMAND, which the launching script sets, or else "evodevo".
std::string program_name();

/// Returns a word as a shell takes it: in quotes, if it has characters that mean something to a shell.
std::string shell_word(std::string_view word);

/// Returns a call of this program, such as "evodevo show 'runs/my robot-1'", that users can paste into a shell.
std::string shell_command(std::initializer_list<std::string_view> words);

/// Returns `text` in a form that cannot break lines of a message, table or log, or disturb a terminal. Control
/// characters, characters that change the text direction, and bytes that are not UTF-8 become escapes such as \n and
/// \x1b; all other UTF-8 stays as it is. A result of more than `most` bytes is cut and ends with "...".
std::string printable(std::string_view text, std::size_t most = 300);

/// Checks a name or another text that will be printed and recorded unchanged. Returns a sentence that begins with the
/// text and says what is wrong, or an empty text if printable() would change nothing.
std::string text_fault(std::string_view text, std::size_t most = 300);

/// Returns a decimal text that reads back as the same number, with no more digits than needed. If the value is not
/// finite, returns "not a number", "infinity" or "-infinity".
std::string to_text(double value);

/// Returns a number with four significant digits, such as "0.1234" or "1.235e+08". If the value is not finite, returns
/// the same text as to_text().
std::string short_number(double value);

/// Returns a number with four significant digits and its unit, such as "0.1234 m". The unit "1", of a number without
/// dimension, is left out.
std::string short_quantity(double value, const std::string& unit);

/// Returns a text such as "0 to 1", "at least 0" or "at most 1", without the unit, or an empty text if every value is
/// allowed.
std::string to_text(const Range& range);

/// Joins texts, for example to "a, b, c".
std::string joined(std::span<const std::string> items, std::string_view separator = ", ");

/// Wraps a text to lines of at most 80 characters. Indents all lines except the first by `indent` spaces.
std::string wrapped(const std::string& text, std::size_t indent = 0);

/// Replaces every `mark` in `text` with `value`.
void replace_all(std::string& text, std::string_view mark, std::string_view value);

/// Returns the candidate that is most similar to `word`, or an empty text if none is similar.
std::string nearest(std::string_view word, std::span<const std::string> candidates);

/// Returns `; did you mean "x"?` with the nearest candidate. If none is similar, or if there are at most three
/// candidates, returns `; known: a, b, c`.
std::string suggestion(std::string_view word, std::span<const std::string> candidates);

}  // namespace evodevo
