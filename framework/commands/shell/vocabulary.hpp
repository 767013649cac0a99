// What the placeholders of arguments and options stand for, for those who complete them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "commands/shell/command.hpp"

namespace evodevo {

struct Vocabulary {
  enum class Source { nothing, words, files, folders, operators };

  Source source = Source::nothing;
  std::vector<std::string> words = {};  ///< of Source::words
};

/// `placeholder` is such as "DIR" or "EXPERIMENT.toml", or all words themselves, such as "bash|zsh|fish".
Vocabulary vocabulary_of(const std::string& placeholder, std::span<const Command> commands);

}  // namespace evodevo
