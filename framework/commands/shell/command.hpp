// What a command declares of itself. The reading of its arguments, its --help, the completion of shells and the manual
// page all come from this declaration.
#pragma once

#include <boost/program_options.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/input_error.hpp"

namespace evodevo {

/// The words behind a command's name.
using Arguments = std::vector<std::string>;
using Options = boost::program_options::options_description;
/// The values of arguments and options, by their names.
using Given = boost::program_options::variables_map;

/// A command line that does not make sense.
struct UsageError : InputError {
  using InputError::InputError;
};

enum class Count { one, optional, one_or_more };

struct Argument {
  std::string name;  ///< a placeholder such as "DIR" (see vocabulary.hpp), or all its values: "bash|zsh|fish"
  Count count = Count::one;
};

struct Command {
  std::string name;
  std::vector<Argument> arguments;    ///< only the last one may be optional or repeated
  std::string summary;                ///< one line, in the imperative
  std::vector<std::string> text;      ///< paragraphs that say more
  std::vector<std::string> examples;  ///< each without the name of the program: "show runs/quickstart-1"
  Options options;                    ///< without common_options()
  /// Returns the exit code: 0 done, 1 the run or simulation failed, 130 interrupted. Bad input is thrown as InputError
  /// (exit code 2). What it prints through std::cout or stdio is checked when it is done (exit code 1).
  int (*function)(const Given&);
  bool watches_operators = true;  ///< whether calls of operators that last too long are named
};

/// --help, --quiet and --verbose, which every command has.
const Options& common_options();

/// "run EXPERIMENT.toml"
std::string call_of(const Command& command);
/// "run EXPERIMENT.toml [options]"
std::string usage_of(const Command& command);

/// A placeholder such as "DIR" for the value of an option; empty where the option has none.
std::string value_name_of(const boost::program_options::option_description& option);
/// An option that takes a value of type T.
template <class T>
boost::program_options::typed_value<T>* value(const char* name) {
  return boost::program_options::value<T>()->value_name(name);
}
/// The same of an option that may be repeated; its type is std::vector<T>.
template <class T>
boost::program_options::typed_value<std::vector<T>>* values(const char* name) {
  return value<std::vector<T>>(name)->composing();
}

/// The values that the command line gives. Throws UsageError, also where an argument is missing, unless --help is
/// given.
Given parse(const Command& command, const Arguments& arguments);

/// Reads the arguments, sets how much is said, and runs the command, or prints its help where --help is given. Throws
/// what the command throws, and UsageError, also where what it prints would go into a file that it reads.
int call(const Command& command, const Arguments& arguments);

}  // namespace evodevo
