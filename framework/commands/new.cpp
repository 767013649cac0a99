// evodevo new: creates the project of a plugin.
#include <algorithm>
#include <boost/dll/runtime_symbol_info.hpp>
#include <cctype>
#include <fstream>
#include <sstream>

#include "base/output_file.hpp"
#include "base/text.hpp"
#include "commands/commands.hpp"
#include "commands/shell/output/notices.hpp"
#include "operators/loader.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

/// Returns the folder of the template, which has the same place relative to the program in the build folder and in the
/// installed package.
fs::path template_folder() {
  const fs::path program = boost::dll::program_location();
  return program.parent_path().parent_path() / "share/evodevo/template";
}

/// An operator of a new project.
struct NewOperator {
  std::string kind, name;
};

/// Returns "new KIND NAME", with which a message about an operator begins.
std::string call_for(const NewOperator& one) { return "new " + printable(one.kind) + " " + printable(one.name); }

void check_kind(const std::string& kind) {
  static const std::vector<std::string> kinds(operator_kinds.begin(), operator_kinds.end());
  if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
    throw UsageError("new " + printable(kind) + ": is not a kind of operator" + suggestion(kind, kinds));
}

bool is_letter(char c) { return c >= 'a' && c <= 'z'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Returns whether a name consists of words that begin with a letter, joined by - or "."
bool is_operator_name(std::string_view name) {
  bool begins = true;  // a word must begin here
  for (const char c : name) {
    if (!is_letter(c) && (begins || !(is_digit(c) || c == '-' || c == '.'))) return false;
    begins = c == '-' || c == '.';
  }
  return !begins;
}

void check_name(const std::string& name) {
  constexpr std::size_t longest = 100;  // bytes
  if (name.size() > longest || !is_operator_name(name))
    throw UsageError(
        "new " + printable(name) +
        ": is not a valid operator name; expected at most 100 lowercase letters and digits, in words joined by - or "
        "., such as my-lab.growth");
}

/// Returns the part of an operator's name after the last dot. Hyphens separate its words.
std::string last_part(const std::string& name) { return name.substr(name.rfind('.') + 1); }

/// Returns, for example, "mass_turnover" for "my-lab.mass-turnover".
std::string file_name(const std::string& name) {
  std::string file = last_part(name);
  std::replace(file.begin(), file.end(), '-', '_');
  return file;
}

/// Returns, for example, "MassTurnover" for "my-lab.mass-turnover".
std::string class_name(const std::string& name) {
  std::istringstream words(last_part(name));
  std::string text;
  for (std::string word; std::getline(words, word, '-');) {
    word.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(word.front())));
    text += word;
  }
  return text;
}

std::string a_kind(const std::string& kind) { return (kind == "encoding" ? "an " : "a ") + kind; }

/// Throws UsageError if two operators cannot be in one project, which has one folder for their sources and one
/// experiment that uses both.
void check_together(const NewOperator& earlier, const NewOperator& later) {
  if (later.name == earlier.name)
    throw UsageError(call_for(later) + ": " + a_kind(earlier.kind) +
                     " operator of the project has this name already; give another name");
  if (last_part(later.name) == last_part(earlier.name))
    throw UsageError(call_for(later) + ": " + file_name(later.name) + ".cpp and the class " + class_name(later.name) +
                     " are those of " + earlier.name + "; give a name that ends differently");
  if (later.kind == earlier.kind && (later.kind == "encoding" || later.kind == "selection"))
    throw UsageError(call_for(later) + ": an experiment has one " + later.kind + ", here " + earlier.name +
                     "; create " + later.name + " in a project of its own");
}

/// Returns the operators that the command line names. Throws UsageError if they cannot make a project.
std::vector<NewOperator> wanted_operators(const Given& given) {
  std::vector<std::string> words = {given["KIND"].as<std::string>(), given["NAME"].as<std::string>()};
  if (given.contains("KIND NAME")) {
    const auto more = given["KIND NAME"].as<std::vector<std::string>>();
    words.insert(words.end(), more.begin(), more.end());
  }
  std::vector<NewOperator> wanted;
  for (std::size_t i = 0; i < words.size(); i += 2) {
    check_kind(words[i]);
    if (i + 1 == words.size())
      throw UsageError("new " + words[i] + ": has no name; give a kind and a name for each operator");
    check_name(words[i + 1]);
    const NewOperator later{words[i], words[i + 1]};
    for (const NewOperator& earlier : wanted) check_together(earlier, later);
    wanted.push_back(later);
  }
  return wanted;
}

/// Returns, for example, "`my-lab.growth` (devo) and `my-lab.height` (fitness)".
std::string listed(const std::vector<NewOperator>& operators) {
  std::string text;
  for (std::size_t i = 0; i < operators.size(); ++i)
    text += (i == 0                     ? ""
             : i + 1 < operators.size() ? ", "
                                        : " and ") +
            ("`" + operators[i].name) + "` (" + operators[i].kind + ")";
  return text;
}

void replace_marks(std::string& text, const NewOperator& one) {
  std::string kind = a_kind(one.kind);
  kind.front() = 'A';
  replace_all(text, "@NAME@", one.name);
  replace_all(text, "@FILE@", file_name(one.name));
  replace_all(text, "@CLASS@", class_name(one.name));
  replace_all(text, "@A_KIND@", kind);
}

/// Returns whether a section of a template that is not repeated belongs to a project; see from_template().
bool is_wanted(const std::string& section, const std::vector<NewOperator>& operators) {
  const auto has = [&](const std::string& kind) {
    return std::any_of(operators.begin(), operators.end(), [&](const NewOperator& one) { return one.kind == kind; });
  };
  if (section.starts_with("with ")) return has(section.substr(5));
  if (section.starts_with("no ")) return !has(section.substr(3));
  return section == "end" || section == (operators.size() == 1 ? "one" : "several");
}

/// Returns a section of a template for the operators of a project; see from_template().
std::string filled(const std::string& section, std::string text, const std::vector<NewOperator>& operators) {
  if (is_wanted(section, operators)) {
    replace_all(text, "@OPERATORS@", listed(operators));
    replace_marks(text, operators.front());
    return text;
  }
  std::string all;
  for (const NewOperator& one : operators)
    if (section == "each" || section == one.kind) {
      all += text;
      replace_marks(all, one);
    }
  return all;
}

bool begins_section(const std::string& line) {
  return line.size() > 2 && line.starts_with('@') && line.ends_with('@') &&
         std::all_of(line.begin() + 1, line.end() - 1, [](char c) { return is_letter(c) || c == ' '; });
}

/// Returns the text of a template for the operators of a project. A line such as "@devo@" begins a section, which ends
/// at the next line of this form:
///   @KIND@, @each@         repeated for each operator of the kind, or of any kind
///   @with KIND@, @no KIND@ if the project has an operator of the kind, or none
///   @one@, @several@       if the project has one operator, or several
///   @end@                  always
/// Within a section, marks such as @NAME@ stand for the operator for which it is repeated, or for the first one.
std::string from_template(std::istream& source, const std::vector<NewOperator>& operators) {
  std::string section = "end", text, lines;
  for (std::string line; std::getline(source, line);)
    if (begins_section(line)) {
      text += filled(section, lines, operators);
      section = line.substr(1, line.size() - 2);
      lines.clear();
    } else {
      lines += line + "\n";
    }
  return text + filled(section, lines, operators);
}

void write_from(const fs::path& from, const fs::path& to, const std::vector<NewOperator>& operators) {
  std::ifstream source(from);
  if (!source) throw std::runtime_error(from.string() + ": cannot be read; install evodevo again");
  write_file(to, from_template(source, operators));
}

int create(const Given& given) {
  const std::vector<NewOperator> operators = wanted_operators(given);
  const std::string folder = operators.front().name;
  std::error_code error;
  if (!fs::create_directory(folder, error))
    throw UsageError(folder + ": cannot be created: " + (error ? error.message() : "it exists already") +
                     "; give another name, or call this in another folder");
  try {
    for (const char* file : {"CMakeLists.txt", "README.md", "experiment.toml"})
      write_from(template_folder() / file, fs::path(folder) / file, operators);
    for (const NewOperator& one : operators)
      write_from(template_folder() / "operator.cpp", fs::path(folder) / (file_name(one.name) + ".cpp"), {one});
  } catch (...) {
    fs::remove_all(folder, error);  // an incomplete project would make the next attempt fail
    throw;
  }
  for (const NewOperator& one : operators)
    remarks() << one.name << ": " << a_kind(one.kind) << " operator in " << folder << "/" << file_name(one.name)
              << ".cpp\n";
  remarks() << "next:\n"
            << "  cd " << folder << " && cmake -B build && cmake --build build && ctest --test-dir build\n";
  return 0;
}

}  // namespace

Command new_command() {
  return {
      .name = "new",
      .arguments = {{"KIND"}, {"NAME"}, {"KIND NAME", Count::pairs}},
      .summary = "Write the project of a new plugin",
      .text = {"KIND is encoding, mutation, crossover, devo, fitness or selection. The project is a new folder NAME "
               "with an operator that works, an experiment that uses it, and tests. It builds against the installed "
               "evodevo.",
               "If several kinds and names are given, the project has several operators, each in a library of its own, "
               "and one experiment that uses all of them. The folder is named after the first one."},
      .examples = {"new devo my-lab.growth", "new devo my-lab.growth fitness my-lab.height"},
      .options = {},
      .function = create};
}

}  // namespace evodevo
