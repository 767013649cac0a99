#include "commands/shell/output/complaint.hpp"

#include <unistd.h>

#include <iostream>
#include <sstream>

#include "base/text.hpp"
#include "commands/shell/output/excerpt.hpp"
#include "commands/shell/output/terminal.hpp"
#include "experiment/config_errors.hpp"
#include "experiment/device.hpp"

namespace evodevo {
namespace {

/// Prints an error message, and returns `exit_code`.
int complain(const std::exception& error, int exit_code) {
  std::istringstream lines(error.what() + remedy_for(error));
  std::string line;
  const auto say = [&](const char* before) {
    std::cerr << before << printable(line, InputError::longest_message) << '\n';
  };
  std::getline(lines, line);
  say(shows_colours(STDERR_FILENO) ? "\x1b[1;31mevodevo:\x1b[0m " : "evodevo: ");
  while (std::getline(lines, line)) say("");
  if (isatty(STDERR_FILENO) == 1) std::cerr << excerpt_for(error.what());
  return exit_code;
}

/// Prints the errors of an experiment, each as complain() does, and their number if there are several.
int complain_of_all(const ConfigErrors& errors) {
  for (const ConfigError& error : errors.all) complain(error, 2);
  const std::size_t count = errors.all.size();
  if (count > 1) std::cerr << "evodevo: " << count << (errors.is_complete ? " errors\n" : " errors or more\n");
  return 2;
}

}  // namespace

int or_complain(const std::function<int()>& work) {
  try {
    return work();
  } catch (const ConfigErrors& errors) {
    return complain_of_all(errors);
  } catch (const InputError& error) {
    return complain(error, 2);
  } catch (const std::exception& error) {
    return complain(error, 1);
  }
}

}  // namespace evodevo
