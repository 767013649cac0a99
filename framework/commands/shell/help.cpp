#include "commands/shell/help.hpp"

#include <algorithm>

#include "base/text.hpp"

namespace evodevo {
namespace {

std::string padded(const std::string& text, std::size_t size) {
  return text + std::string(size - std::min(size, text.size()), ' ');
}

}  // namespace

void print_overview(std::ostream& stream, std::span<const Command> commands) {
  stream << "evodevo " EVODEVO_VERSION " evolves soft robots whose bodies develop during their lives.\n\n";
  std::size_t longest = 0;
  for (const Command& command : commands) longest = std::max(longest, call_of(command).size());
  for (const Command& command : commands)
    stream << "  " << program_name() << ' ' << padded(call_of(command), longest + 2) << command.summary << '\n';
  stream << "\nEach command explains itself with --help. More to read:\n\n";
  for (const Topic& topic : topics())
    stream << "  " << program_name() << ' ' << padded("help " + topic.name, longest + 2) << topic.summary << '\n';
}

void print_help(std::ostream& stream, const Command& command) {
  stream << "usage: " << program_name() << ' ' << usage_of(command) << "\n\n" << command.summary << ".\n";
  for (const std::string& paragraph : command.text) stream << '\n' << wrapped(paragraph) << '\n';
  stream << (command.examples.size() == 1 ? "\nexample:\n" : "\nexamples:\n");
  for (const std::string& example : command.examples) stream << "  " << program_name() << ' ' << example << '\n';
  Options all("options");
  for (const Options* options : {&command.options, &common_options()})
    for (const auto& option : options->options()) all.add(option);
  stream << '\n' << all;
}

void print_topic(std::ostream& stream, const Topic& topic) {
  stream << topic.summary << ".\n";
  for (const std::string& paragraph : topic.text) stream << '\n' << wrapped(paragraph) << '\n';
  for (const Definition& definition : topic.definitions)
    stream << "\n  " << definition.term << "\n      " << wrapped(definition.text, 6) << '\n';
  if (!topic.example.empty()) stream << '\n' << topic.example;
}

}  // namespace evodevo
