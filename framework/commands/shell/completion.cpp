#include "commands/shell/completion.hpp"

#include <boost/algorithm/string/join.hpp>
#include <functional>

#include "base/text.hpp"
#include "commands/shell/vocabulary.hpp"

namespace evodevo {
namespace {

using Source = Vocabulary::Source;
using boost::algorithm::join;

/// An option of a command, with the data that the scripts need.
struct CompletedOption {
  std::string name;   ///< name without dashes
  std::string text;   ///< description
  std::string value;  ///< placeholder of the value; empty if the option takes none
  bool repeatable;
};

std::vector<CompletedOption> options_of(const Command& command) {
  std::vector<CompletedOption> completed;
  for (const Options* options : {&command.options, &common_options()})
    for (const auto& option : options->options())
      completed.push_back(
          {option->long_name(), option->description(), value_name_of(*option), option->semantic()->is_composing()});
  return completed;
}

std::string replaced(std::string text, std::string_view mark, std::string_view value) {
  replace_all(text, mark, value);
  return text;
}

/// Quotes `text` so that a shell reads it as one word.
std::string quoted(const std::string& text) { return "'" + replaced(text, "'", "'\\''") + "'"; }

// ---- bash ----

/// Returns a bash command that offers the possible values of a placeholder. `offer_words` is the name of the shell
/// function that offers words.
std::string bash_offer(const Vocabulary& vocabulary, const std::string& offer_words) {
  switch (vocabulary.source) {
    case Source::words:
      return offer_words + " " + join(vocabulary.words, " ");
    case Source::files:
      return "_evodevo_files -f";
    case Source::folders:
      return "_evodevo_files -d";
    case Source::operators:
      return offer_words + " $(\"$1\" operators --quiet 2>/dev/null | awk '{print $2}')";
    default:
      return "return";
  }
}

constexpr const char* bash_begin = R"sh(# Completion of evodevo for bash: source <(evodevo completion bash)
_evodevo_words() { mapfile -t COMPREPLY < <(compgen -W "$*" -- "$word"); }
_evodevo_files() {
  compopt -o filenames 2>/dev/null
  mapfile -t COMPREPLY < <(compgen "$1" -- "$word")
}
# the same, unless one of them has been given already
_evodevo_once() {
  local given
  for given in "${COMP_WORDS[@]:2:COMP_CWORD-2}"; do
    [[ " $* " != *" $given "* ]] || return
  done
  _evodevo_words "$@"
}
# the same for the first words of pairs
_evodevo_pairs() {
  local given count=0
  for given in "${COMP_WORDS[@]:2:COMP_CWORD-2}"; do
    [[ $given == -* ]] || ((++count))
  done
  ((count % 2)) || _evodevo_words "$@"
}
_evodevo() {
  local word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    _evodevo_words @COMMANDS@ --help --version
    return
  fi
  case ${COMP_WORDS[1]} in
)sh";

std::string bash_case(const Command& command, std::span<const Command> commands) {
  std::string values, names;
  for (const CompletedOption& option : options_of(command)) {
    names += " --" + option.name;
    if (!option.value.empty())
      values += "        --" + option.name + ") " +
                bash_offer(vocabulary_of(option.value, commands), "_evodevo_words") + "; return ;;\n";
  }
  std::string text = "    " + command.name + ")\n";
  if (!values.empty()) text += "      case $previous in\n" + values + "      esac\n";
  text += "      if [[ $word == -* ]]; then\n        _evodevo_words" + names + "\n        return\n      fi\n";
  if (!command.arguments.empty()) {
    const bool in_pairs = command.arguments.back().count == Count::pairs;
    text += "      " +
            bash_offer(vocabulary_of(command.arguments.front().name, commands),
                       in_pairs ? "_evodevo_pairs" : "_evodevo_once") +
            "\n";
  }
  return text + "      ;;\n";
}

std::string bash_script(std::span<const Command> commands) {
  std::vector<std::string> names;
  for (const Command& command : commands) names.push_back(command.name);
  std::string script = replaced(bash_begin, "@COMMANDS@", join(names, " "));
  for (const Command& command : commands) script += bash_case(command, commands);
  return script + "  esac\n}\ncomplete -F _evodevo evodevo\n";
}

// ---- zsh ----

/// Returns the action for zsh's _arguments that offers the possible values of a placeholder.
std::string zsh_action(const Vocabulary& vocabulary) {
  switch (vocabulary.source) {
    case Source::words:
      return "(" + join(vocabulary.words, " ") + ")";
    case Source::files:
      return "_files";
    case Source::folders:
      return "_files -/";
    case Source::operators:
      return "_evodevo_operators";
    default:
      return " ";
  }
}

/// Escapes `text` for a specification of zsh's _arguments or _describe, in which colons and brackets are separators.
std::string zsh_text(std::string text) {
  for (const char* mark : {"\\", ":", "[", "]"}) replace_all(text, mark, std::string("\\") + mark);
  return text;
}

std::string zsh_case(const Command& command, std::span<const Command> commands) {
  std::string text = "    " + command.name + ")\n      _arguments";
  const auto add = [&](const std::string& specification) { text += " \\\n        " + quoted(specification); };
  const auto action = [&](const std::string& placeholder) {
    return ":" + zsh_text(placeholder) + ":" + zsh_action(vocabulary_of(placeholder, commands));
  };
  for (const CompletedOption& option : options_of(command))
    add((option.repeatable ? "*--" : "--") + option.name + (option.value.empty() ? "" : "=") + "[" +
        zsh_text(option.text) + "]" + (option.value.empty() ? "" : action(option.value)));
  for (std::size_t i = 0; i < command.arguments.size(); ++i)
    add((command.arguments[i].is_repeated() ? "*" : std::to_string(i + 1)) + action(command.arguments[i].name));
  return text + "\n      ;;\n";
}

constexpr const char* zsh_begin = R"sh(#compdef evodevo
# Completion of evodevo for zsh: source <(evodevo completion zsh)
_evodevo_operators() {
  local -a names
  names=(${(f)"$($evodevo_program operators --quiet 2>/dev/null | awk '{print $2}')"})
  _describe operator names
}
_evodevo() {
  local evodevo_program=$words[1] context state state_descr line
  local -A opt_args
  _arguments -C '(- *)--help[show the first page of help]' '(- *)--version[show the version]' \
    '1:command:->command' '*::argument:->argument'
  if [[ $state == command ]]; then
    local -a commands
    commands=(
)sh";

constexpr const char* zsh_middle = R"sh(    )
    _describe command commands
    return
  fi
  case $words[1] in
)sh";

constexpr const char* zsh_end = R"sh(  esac
}
if [[ $funcstack[1] == _evodevo ]]; then
  _evodevo "$@"
else
  compdef _evodevo evodevo
fi
)sh";

std::string zsh_script(std::span<const Command> commands) {
  std::string script = zsh_begin;
  for (const Command& command : commands)
    script += "      " + quoted(zsh_text(command.name) + ":" + zsh_text(command.summary)) + "\n";
  script += zsh_middle;
  for (const Command& command : commands) script += zsh_case(command, commands);
  return script + zsh_end;
}

// ---- fish ----

/// Returns the options of fish's `complete` that offer the possible values of a placeholder.
std::string fish_offer(const Vocabulary& vocabulary) {
  switch (vocabulary.source) {
    case Source::words:
      return " -xa " + quoted(join(vocabulary.words, " "));
    case Source::files:
      return " -rF";
    case Source::folders:
      return " -xa '(__fish_complete_directories)'";
    case Source::operators:
      return " -xa '(evodevo operators --quiet 2>/dev/null | string replace -r \"^\\S+\\s+(\\S+).*\" \"\\$1\")'";
    default:
      return " -x";
  }
}

std::string fish_lines(const Command& command, std::span<const Command> commands) {
  const std::string begin = "complete -c evodevo -n '__fish_seen_subcommand_from " + command.name + "'";
  std::string text =
      "complete -c evodevo -n __fish_use_subcommand -fa " + command.name + " -d " + quoted(command.summary) + "\n";
  for (const CompletedOption& option : options_of(command))
    text += begin + " -l " + option.name +
            (option.value.empty() ? std::string(" -f") : fish_offer(vocabulary_of(option.value, commands))) + " -d " +
            quoted(option.text) + "\n";
  if (command.arguments.empty()) return text + begin + " -f\n";
  const Vocabulary vocabulary = vocabulary_of(command.arguments.front().name, commands);
  return text + begin + (vocabulary.source == Source::files ? " -F" : fish_offer(vocabulary)) + "\n";
}

std::string fish_script(std::span<const Command> commands) {
  std::string script =
      "# Completion of evodevo for fish: evodevo completion fish | source\n"
      "complete -c evodevo -n __fish_use_subcommand -f -l help -d 'show the first page of help'\n"
      "complete -c evodevo -n __fish_use_subcommand -f -l version -d 'show the version'\n";
  for (const Command& command : commands) script += fish_lines(command, commands);
  return script;
}

}  // namespace

std::string completion_script(const std::string& shell, std::span<const Command> commands) {
  if (shell == "bash") return bash_script(commands);
  if (shell == "zsh") return zsh_script(commands);
  if (shell == "fish") return fish_script(commands);
  throw UsageError("completion " + printable(shell) + ": is not a supported shell" +
                   suggestion(shell, vocabulary_of(shells, commands).words));
}

}  // namespace evodevo
