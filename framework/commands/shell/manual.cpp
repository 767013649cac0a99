#include "commands/shell/manual.hpp"

#include <algorithm>
#include <cctype>

#include "base/text.hpp"
#include "commands/shell/topics.hpp"

namespace evodevo {
namespace {

/// Escapes `text` so that roff prints it literally.
std::string escaped(std::string text) {
  replace_all(text, "\\", "\\e");
  replace_all(text, "-", "\\-");
  replace_all(text, "'", "\\(aq");
  replace_all(text, "`", "\\(ga");
  replace_all(text, "^", "\\(ha");
  replace_all(text, "~", "\\(ti");
  // roff reads a line that begins with a dot as a request
  replace_all(text, "\n.", "\n\\&.");
  return text.starts_with('.') ? "\\&" + text : text;
}

std::string in_bold(const std::string& text) { return "\\fB" + escaped(text) + "\\fR"; }

std::string section(std::string title) {
  std::transform(title.begin(), title.end(), title.begin(), [](unsigned char c) { return std::toupper(c); });
  return ".SH " + escaped(title) + "\n";
}

std::string paragraph(const std::string& text) { return ".PP\n" + escaped(text) + "\n"; }

/// Returns an item of a definition list: a term and its meaning.
std::string item(const std::string& term, const std::string& text) {
  return ".TP\n" + term + "\n" + escaped(text) + "\n";
}

/// Returns lines that roff does not fill or wrap.
std::string verbatim(const std::string& text) { return ".PP\n.nf\n" + escaped(text) + "\n.fi\n"; }

std::string with_full_stop(const std::string& sentence) { return sentence + "."; }

std::string options_items(const Options& options) {
  std::string text;
  for (const auto& option : options.options()) {
    const std::string value = value_name_of(*option);
    text += item(in_bold("--" + option->long_name()) + (value.empty() ? "" : " \\fI" + escaped(value) + "\\fR"),
                 option->description());
  }
  return text;
}

std::string command_text(const Command& command) {
  std::string text =
      ".SS evodevo " + escaped(usage_of(command)) + "\n" + escaped(with_full_stop(command.summary)) + "\n";
  for (const std::string& lines : command.text) text += paragraph(lines);
  std::string examples;
  for (const std::string& example : command.examples)
    examples += (examples.empty() ? "" : "\n") + ("evodevo " + example);
  return text + verbatim(examples) + options_items(command.options);
}

std::string topic_section(const Topic& topic) {
  std::string title = topic.name;
  std::replace(title.begin(), title.end(), '-', ' ');
  std::string text = section(title) + escaped(with_full_stop(topic.summary)) + "\n";
  for (const std::string& lines : topic.text) text += paragraph(lines);
  for (const Definition& definition : topic.definitions) text += item(in_bold(definition.term), definition.text);
  std::string example = topic.example;
  if (!example.empty()) example.pop_back();  // removes the newline at the end
  return example.empty() ? text : text + verbatim(example);
}

}  // namespace

std::string manual_page(std::span<const Command> commands) {
  std::string page = ".TH EVODEVO 1 \"\" \"evodevo " EVODEVO_VERSION "\" \"User Commands\"\n";
  page += section("Name") + "evodevo \\- evolves soft robots whose bodies develop during their lives\n";
  page += section("Synopsis") + ".nf\n";
  for (const Command& command : commands)
    page += in_bold("evodevo " + command.name) + escaped(usage_of(command).substr(command.name.size())) + "\n";
  page += ".fi\n";
  page += section("Commands");
  for (const Command& command : commands) page += command_text(command);
  page += ".SS Options of every command\n" + options_items(common_options());
  for (const Topic& topic : topics()) page += topic_section(topic);
  return page;
}

}  // namespace evodevo
