// evodevo operators and describe: what the operators say of themselves.
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "commands/options.hpp"
#include "describe.hpp"
#include "text.hpp"

namespace evodevo {
namespace {

using Json = nlohmann::ordered_json;
namespace po = boost::program_options;

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

std::vector<ParameterDescription> parameters_of(const AvailableOperator& available) {
  return describe_parameters(*create<Operator>(available));
}

void print_description(const AvailableOperator& available) {
  std::printf("%s (%s operator, version %s, %s)\n%s\n", available.entry->name, available.entry->kind,
              available.manifest->version, available.manifest->license, available.entry->summary);
  for (const ParameterDescription& p : parameters_of(available)) {
    std::printf("\n  %s = %s\n      %s", p.name.c_str(), p.fallback.c_str(), p.type.c_str());
    if (!p.allowed.empty()) std::printf(", %s", p.allowed.c_str());
    if (!p.unit.empty() && p.unit != "1") std::printf(" %s", p.unit.c_str());
    std::printf("\n      %s\n", p.text.c_str());
  }
  std::printf("\nfrom %s\n", available.file.c_str());
}

}  // namespace

int operators_command(const Arguments& arguments) {
  CommandLine line{"operators [--kind KIND] [--json]", {}, {}};
  line.options.add_options()("kind", po::value<std::string>(),
                             "encoding, mutation, crossover, devo, fitness or selection")(
      "json", "machine-readable, with all parameters");
  const auto given = parse(std::move(line), arguments);
  if (!given) return 0;
  const std::string kind = given->contains("kind") ? (*given)["kind"].as<std::string>() : "";
  static const std::vector<std::string> kinds(operator_kinds.begin(), operator_kinds.end());
  if (!kind.empty() && std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
    throw UsageError("--kind " + kind + ": is not a kind of operator" + suggestion(kind, kinds));
  const Registry registry({builtin_plugin_folder()});
  Json list = Json::array();
  for (const AvailableOperator& available : registry.operators()) {
    if (!kind.empty() && kind != available.entry->kind) continue;
    if (given->contains("json"))
      list.push_back({{"kind", available.entry->kind},
                      {"name", available.entry->name},
                      {"summary", available.entry->summary},
                      {"version", available.manifest->version},
                      {"license", available.manifest->license},
                      {"file", available.file.string()},
                      {"parameters", parameters_json(parameters_of(available))}});
    else
      std::printf("%-10s %-20s %s\n", available.entry->kind, available.entry->name, available.entry->summary);
  }
  if (given->contains("json")) std::cout << list.dump(1) << '\n';
  for (const FailedLibrary& failed : registry.failed())
    std::cerr << "warning: not usable: " << failed.file.string() << ": " << failed.reason << '\n';
  return 0;
}

int describe_command(const Arguments& arguments) {
  const auto given = parse({"describe OPERATOR", {"OPERATOR"}, {}}, arguments);
  if (!given) return 0;
  const auto wanted = (*given)["OPERATOR"].as<std::string>();
  const Registry registry({builtin_plugin_folder()});
  std::vector<std::string> names;
  bool found = false;
  for (const AvailableOperator& available : registry.operators()) {
    names.emplace_back(available.entry->name);
    if (wanted != available.entry->name) continue;
    print_description(available);
    found = true;
  }
  if (!found) throw UsageError("no operator is called \"" + wanted + "\"" + suggestion(wanted, names));
  return 0;
}

}  // namespace evodevo
