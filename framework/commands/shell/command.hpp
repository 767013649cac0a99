// The declaration of a command, which determines how arguments are parsed, the text of --help, the completion in shells
// and the manual page.
#pragma once

#include <boost/program_options.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/input_error.hpp"

namespace evodevo {

/// The words after a command's name on the command line.
using Arguments = std::vector<std::string>;
using Options = boost::program_options::options_description;
/// The values of arguments and options, by their names.
using Given = boost::program_options::variables_map;

/// Thrown for a command line with an error.
struct UsageError : InputError {
  using InputError::InputError;
};

/// How often an argument is given. `pairs`: any number of times two words, such as "KIND NAME".
enum class Count { one, optional, one_or_more, pairs };

struct Argument {
  std::string name;  ///< placeholder such as "DIR" (see vocabulary.hpp), or all allowed values, such as "bash|zsh|fish"
  Count count = Count::one;

  bool is_repeated() const { return count == Count::one_or_more || count == Count::pairs; }
  bool is_needed() const { return count == Count::one || count == Count::one_or_more; }
};

struct Command {
  std::string name;
  std::vector<Argument> arguments;    ///< arguments in order; only the last one may be optional or repeated
  std::string summary;                ///< one line, in the imperative
  std::vector<std::string> text;      ///< paragraphs with details
  std::vector<std::string> examples;  ///< calls without the name of the program, such as "show runs/quickstart-1"
  Options options;                    ///< options of this command, without common_options()
  /// Executes the command and returns the exit code: 0 if the command succeeded, 1 if the run or simulation failed, 130
  /// if it was interrupted. Throws InputError for bad input (exit code 2). After it returns, the program checks whether
  /// its output through std::cout and stdio could be written (exit code 1 if not).
  int (*function)(const Given&);
  bool watches_operators = true;  ///< whether the program reports calls of operators that take too long
};

/// Returns the options that every command has: --help, --quiet and --verbose.
const Options& common_options();

/// Returns, for example, "run EXPERIMENT.toml".
std::string call_of(const Command& command);
/// Returns, for example, "run EXPERIMENT.toml [options]".
std::string usage_of(const Command& command);

/// Returns the placeholder for the value of an option, such as "DIR", or an empty text if the option takes no value.
std::string value_name_of(const boost::program_options::option_description& option);
/// Declares that an option takes a value of type T. `name` is the placeholder of the value.
template <class T>
boost::program_options::typed_value<T>* value(const char* name) {
  return boost::program_options::value<T>()->value_name(name);
}
/// Declares that an option takes a value of type T and may be repeated. `name` is the placeholder of the values.
template <class T>
boost::program_options::typed_value<std::vector<T>>* values(const char* name) {
  return value<std::vector<T>>(name)->composing();
}

/// Returns the values of arguments and options on a command line. Throws UsageError if the command line has an error. A
/// missing argument is not an error if --help is given.
Given parse(const Command& command, const Arguments& arguments);

/// Parses the arguments, sets the verbosity, and executes the command or, if --help is given, prints its help. Throws
/// what the command throws, and UsageError if the arguments have errors or if standard output goes to a file that the
/// command reads.
int call(const Command& command, const Arguments& arguments);

}  // namespace evodevo
