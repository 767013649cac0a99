// The possible values of the placeholders of arguments and options, for completion.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "commands/shell/command.hpp"

namespace evodevo {

struct Vocabulary {
  enum class Source { nothing, words, files, folders, operators };

  Source source = Source::nothing;
  std::vector<std::string> words = {};  ///< all possible values, if the source is Source::words
};

/// Returns the possible values of a placeholder. The placeholder is a name, such as "DIR" or "EXPERIMENT.toml", or a
/// list of all possible values, such as "bash|zsh|fish".
Vocabulary vocabulary_of(const std::string& placeholder, std::span<const Command> commands);

}  // namespace evodevo
