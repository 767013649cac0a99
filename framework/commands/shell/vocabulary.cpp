#include "commands/shell/vocabulary.hpp"

#include <algorithm>
#include <sstream>

#include "commands/shell/topics.hpp"
#include "operators/loader.hpp"

namespace evodevo {
namespace {

std::vector<std::string> parts_of(const std::string& alternatives) {
  std::vector<std::string> parts;
  std::istringstream stream(alternatives);
  for (std::string part; std::getline(stream, part, '|');) parts.push_back(part);
  return parts;
}

std::vector<std::string> topics_and(std::span<const Command> commands) {
  std::vector<std::string> names;
  for (const Topic& topic : topics()) names.push_back(topic.name);
  for (const Command& command : commands) names.push_back(command.name);
  return names;
}

}  // namespace

Vocabulary vocabulary_of(const std::string& placeholder, std::span<const Command> commands) {
  using Source = Vocabulary::Source;
  static const std::vector<std::string> of_files = {"FILE", "PATH", "LIBRARY", "EXPERIMENT.toml", "BODY.json"};
  if (placeholder.find('|') != placeholder.npos) return {Source::words, parts_of(placeholder)};
  if (placeholder == "DIR") return {Source::folders};
  if (placeholder == "OPERATOR") return {Source::operators};
  if (placeholder == "KIND" || placeholder == "KIND NAME")
    return {Source::words, {operator_kinds.begin(), operator_kinds.end()}};
  if (placeholder == "TOPIC") return {Source::words, topics_and(commands)};
  if (std::find(of_files.begin(), of_files.end(), placeholder) != of_files.end()) return {Source::files};
  return {};
}

}  // namespace evodevo
