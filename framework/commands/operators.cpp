// evodevo operators and describe: list operators, and describe them from their declarations.
#include <fmt/ostream.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "base/json_text.hpp"
#include "base/text.hpp"
#include "commands/commands.hpp"
#include "commands/shell/options.hpp"
#include "commands/shell/output/notices.hpp"
#include "experiment/tables/reference.hpp"
#include "operators/describe.hpp"
#include "operators/reference.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;

Json parameters_json(const std::vector<ParameterDescription>& parameters) {
  Json list = Json::array();
  for (const ParameterDescription& p : parameters)
    list.push_back({{"name", p.name},
                    {"type", p.type},
                    {"default", p.fallback},
                    {"allowed", p.allowed},
                    {"unit", p.unit},
                    {"text", p.text}});
  return list;
}

void print_description(const AvailableOperator& available) {
  fmt::print(std::cout, "{} ({} operator, version {}, {})\n{}\n", available.entry->name, available.entry->kind,
             available.manifest->version, available.manifest->license, available.entry->summary);
  for (const ParameterDescription& p : describe_parameters(available)) {
    std::cout << "\n  " << p.name << " = " << p.fallback << "\n      " << p.type;
    if (!p.allowed.empty()) std::cout << ", " << p.allowed;
    if (!p.unit.empty() && p.unit != "1") std::cout << ' ' << p.unit;
    std::cout << "\n      " << p.text << '\n';
  }
  std::cout << "\nfrom " << printable(available.file.string()) << '\n';
}

/// Returns the value of --kind, or an empty text if it is not given, which stands for all kinds.
std::string given_kind(const Given& given) {
  if (!given.contains("kind")) return "";
  const auto kind = given["kind"].as<std::string>();
  static const std::vector<std::string> kinds(operator_kinds.begin(), operator_kinds.end());
  if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
    throw UsageError("--kind " + printable(kind) + ": is not a kind of operator" + suggestion(kind, kinds));
  return kind;
}

Json operator_json(const AvailableOperator& available) {
  return {{"kind", available.entry->kind},
          {"name", available.entry->name},
          {"summary", available.entry->summary},
          {"version", available.manifest->version},
          {"license", available.manifest->license},
          {"file", available.file.string()},
          {"parameters", parameters_json(describe_parameters(available))}};
}

void print_operators(const Registry& registry, const std::string& kind, bool as_json) {
  Json list = Json::array();
  for (const AvailableOperator& available : registry.operators()) {
    if (!kind.empty() && kind != available.entry->kind) continue;
    if (as_json)
      list.push_back(operator_json(available));
    else
      fmt::print(std::cout, "{:<10} {:<20} {}\n", available.entry->kind, available.entry->name,
                 available.entry->summary);
  }
  if (as_json) std::cout << json_text(list) << '\n';
}

void print_failed(const Registry& registry, bool as_json) {
  Json list = Json::array();
  for (const FailedLibrary& failed : registry.failed()) {
    if (as_json)
      list.push_back({{"file", failed.file.string()}, {"reason", failed.reason}});
    else
      std::cout << printable(failed.file.string()) << ": " << failed.reason << '\n';
  }
  if (as_json) std::cout << json_text(list) << '\n';
}

Registry registry_for(const Given& given) {
  return timed("loading all operators", [&] { return Registry(plugin_search_path(given_plugin_path(given))); });
}

int operators(const Given& given) {
  const std::string kind = given_kind(given);
  for (const char* whole : {"failed", "markdown"})
    if (given.contains(whole) && !kind.empty())
      throw UsageError("--kind " + kind + ": --" + whole + " is about all kinds; leave one of them out");
  if (given.contains("markdown") && (given.contains("json") || given.contains("failed")))
    throw UsageError("--markdown: is a page of its own; leave it out, or --json and --failed");
  const Registry registry = registry_for(given);
  if (given.contains("failed")) {
    print_failed(registry, given.contains("json"));
    return 0;
  }
  if (given.contains("markdown"))
    std::cout << reference_page(registry);
  else
    print_operators(registry, kind, given.contains("json"));
  if (!registry.failed().empty())
    std::cerr << "warning: " << registry.failed().size() << " libraries cannot be used; see `" << program_name()
              << " operators --failed`\n";
  return 0;
}

int describe(const Given& given) {
  const auto wanted = given["OPERATOR"].as<std::string>();
  if (wanted == "experiment") {
    std::cout << experiment_reference();
    return 0;
  }
  const Registry registry = registry_for(given);
  std::vector<std::string> names;
  bool found = false;
  for (const AvailableOperator& available : registry.operators()) {
    names.emplace_back(available.entry->name);
    if (wanted != available.entry->name) continue;
    if (given.contains("markdown"))
      std::cout << reference_of(available, 2);
    else
      print_description(available);
    found = true;
  }
  if (!found) throw UsageError("no operator is called \"" + printable(wanted) + "\"" + suggestion(wanted, names));
  return 0;
}

}  // namespace

Command operators_command() {
  Options options;
  options.add_options()("kind", value<std::string>("KIND"),
                        "list only operators of one kind: encoding, mutation, crossover, devo, fitness or selection")(
      "failed", "list the libraries that cannot be used, and why")("json", "print JSON, with all parameters")(
      "markdown", "print the reference page of all operators and parameters");
  add_plugin_option(options);
  return {.name = "operators",
          .arguments = {},
          .summary = "List the operators that experiments can name",
          .text = {"`help plugins` says where evodevo looks for them."},
          .examples = {"operators --kind devo", "operators --failed"},
          .options = options,
          .function = operators};
}

Command describe_command() {
  Options options;
  options.add_options()("markdown", "print the description as a section of a Markdown page");
  add_plugin_option(options);
  return {.name = "describe",
          .arguments = {{"OPERATOR"}},
          .summary = "Explain an operator and its parameters",
          .text = {"For each parameter it prints the default, the range, the unit and a description. "
                   "`describe experiment` prints a page of the tables and keys of an experiment."},
          .examples = {"describe spring-turnover", "describe experiment"},
          .options = options,
          .function = describe};
}

}  // namespace evodevo
