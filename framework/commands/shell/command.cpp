#include "commands/shell/command.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <iostream>

#include "archive/archive.hpp"
#include "base/text.hpp"
#include "commands/shell/help.hpp"
#include "commands/shell/output/notices.hpp"

namespace evodevo {

namespace po = boost::program_options;
namespace fs = std::filesystem;

namespace {

/// Throws UsageError if standard output goes to the file `input` or, if `input` is the folder of a run, to the run's
/// file.
void refuse_to_print_into(const std::string& input) {
  struct stat output = {}, read = {};
  if (fstat(STDOUT_FILENO, &output) != 0 || !S_ISREG(output.st_mode)) return;
  for (const fs::path& file : {fs::path(input), fs::path(input) / database_name})
    if (stat(file.c_str(), &read) == 0 && read.st_dev == output.st_dev && read.st_ino == output.st_ino)
      throw UsageError(file.string() +
                       ": the command reads this file, so its output cannot go there; send the "
                       "standard output to another file");
}

std::vector<std::string> values_of(const Given& given, const Argument& argument) {
  if (!given.contains(argument.name)) return {};
  if (argument.is_repeated()) return given[argument.name].as<std::vector<std::string>>();
  return {given[argument.name].as<std::string>()};
}

std::string usage_note(const Command& command) { return "; usage: " + program_name() + " " + usage_of(command); }

Verbosity verbosity_of(const Given& given) {
  if (given.contains("quiet") && given.contains("verbose"))
    throw UsageError("--quiet and --verbose contradict each other; give one of them");
  return given.contains("quiet")     ? Verbosity::quiet
         : given.contains("verbose") ? Verbosity::verbose
                                     : Verbosity::normal;
}

}  // namespace

const Options& common_options() {
  static const Options options = [] {
    Options common;
    common.add_options()("quiet", "print nothing but results, warnings and errors")(
        "verbose", "also print what slow steps do and how long they take")("help", "show this text");
    return common;
  }();
  return options;
}

std::string call_of(const Command& command) {
  std::string text = command.name;
  for (const Argument& argument : command.arguments)
    text += argument.count == Count::optional      ? " [" + argument.name + "]"
            : argument.count == Count::pairs       ? " [" + argument.name + "...]"
            : argument.count == Count::one_or_more ? " " + argument.name + "..."
                                                   : " " + argument.name;
  return text;
}

std::string usage_of(const Command& command) { return call_of(command) + " [options]"; }

std::string value_name_of(const po::option_description& option) {
  if (option.semantic()->max_tokens() == 0) return "";
  const std::string name = option.semantic()->name();  // such as "N (=3)" if the option has a default
  return name.substr(0, name.find(" (="));
}

namespace {

/// Returns a note such as "; --seed N: seed of all random numbers" on the option with a name such as "--seed".
std::string meaning_of(const std::string& name, const Options& options) {
  const po::option_description* option =
      options.find_nothrow(name.substr(std::min(name.size(), std::size_t{2})), false);
  if (option == nullptr) return "";
  return "; " + name + " " + value_name_of(*option) + ": " + option->description();
}

}  // namespace

Given parse(const Command& command, const Arguments& arguments) {
  Options all;
  all.add(command.options).add(common_options());
  po::positional_options_description positional;
  for (const Argument& argument : command.arguments) {
    if (argument.is_repeated())
      all.add_options()(argument.name.c_str(), po::value<std::vector<std::string>>());
    else
      all.add_options()(argument.name.c_str(), po::value<std::string>());
    positional.add(argument.name.c_str(), argument.is_repeated() ? -1 : 1);
  }
  Given given;
  try {
    po::store(po::command_line_parser(arguments).options(all).positional(positional).run(), given);
  } catch (const po::unknown_option& error) {
    std::vector<std::string> known;
    for (const auto& option : all.options()) known.push_back("--" + option->long_name());
    const std::string near = nearest(error.get_option_name(), known);
    throw UsageError(printable(error.what()) + (near.empty() ? "" : "; did you mean \"" + near + "\"?") +
                     usage_note(command));
  } catch (const po::validation_error& error) {
    throw UsageError(printable(error.what()) + meaning_of(error.get_option_name(), all) + usage_note(command));
  } catch (const po::error& error) {
    throw UsageError(printable(error.what()) + usage_note(command));
  }
  for (const Argument& argument : command.arguments)
    if (argument.is_needed() && !given.contains(argument.name) && !given.contains("help"))
      throw UsageError(argument.name + " is missing" + usage_note(command));
  return given;
}

int call(const Command& command, const Arguments& arguments) {
  const Given given = parse(command, arguments);
  if (given.contains("help")) {
    print_help(std::cout, command);
    return 0;
  }
  set_verbosity(verbosity_of(given));
  for (const Argument& argument : command.arguments)
    for (const std::string& input : values_of(given, argument)) refuse_to_print_into(input);
  return command.function(given);
}

}  // namespace evodevo
