// Describes the parameters that an operator declares.
#pragma once

#include <string>
#include <vector>

#include "base/text.hpp"
#include "evodevo/operator.hpp"

namespace evodevo {

struct AvailableOperator;

/// The description of one declared parameter.
struct ParameterDescription {
  std::string name;
  std::string type;      ///< "number", "whole number", "true or false", "option", …
  std::string fallback;  ///< default value, as in a TOML file
  std::string allowed;   ///< range or options; empty if every value of the type is allowed
  std::string unit;
  std::string text;
};

/// A visitor that collects the descriptions of declared parameters. `Visitor` is Parameters, or a derived interface
/// with more types of values.
template <class Visitor>
class Describer : public Visitor {
 public:
  std::vector<ParameterDescription> found;

  void real(double& value, std::string_view name, Range range, std::string_view text) override {
    add(name, "number", to_text(value), range, text);
  }
  void integer(std::int64_t& value, std::string_view name, Range range, std::string_view text) override {
    add(name, "whole number", std::to_string(value), range, text);
  }
  void flag(bool& value, std::string_view name, std::string_view text) override {
    add(name, "true or false", value ? "true" : "false", {}, text);
  }
  void choice(std::string& value, std::string_view name, std::initializer_list<std::string_view> options,
              std::string_view text) override {
    add(name, "option", in_quotes(value), {}, text);
    found.back().allowed = quoted(options);
  }
  void vector(Vec3& value, std::string_view name, Range range, std::string_view text) override {
    add(name, "three numbers", "[" + to_text(value.x) + ", " + to_text(value.y) + ", " + to_text(value.z) + "]", range,
        text);
  }
  void vector_or_choice(Vec3& value, std::string& word, std::string_view name, Range range,
                        std::initializer_list<std::string_view> options, std::string_view text) override {
    vector(value, name, range, text);
    if (!word.empty()) found.back().fallback = printable(in_quotes(word));
    found.back().type += " or option";
    found.back().allowed += ", or " + quoted(options);
  }
  void counts(std::array<std::int64_t, 3>& value, std::string_view name, Range range, std::string_view text) override {
    add(name, "three whole numbers",
        "[" + std::to_string(value[0]) + ", " + std::to_string(value[1]) + ", " + std::to_string(value[2]) + "]", range,
        text);
  }
  void optional_real(std::optional<double>& value, std::string_view name, Range range, std::string_view text) override {
    add(name, "number", value ? to_text(*value) : "none", range, text);
  }
  void reals(std::vector<double>& value, std::string_view name, Range range, std::string_view text) override {
    std::vector<std::string> numbers;
    for (const double number : value) numbers.push_back(to_text(number));
    add(name, "list of numbers", "[" + joined(numbers) + "]", range, text);
  }
  void text(std::string& value, std::string_view name, std::string_view text) override {
    add(name, "text", in_quotes(value), {}, text);
  }
  void file(InputFile& value, std::string_view name, std::string_view text) override {
    add(name, "file", value.path.empty() ? "none" : in_quotes(value.path), {}, text);
  }
  void materials(std::vector<std::string>& value, std::string_view name, std::string_view text) override {
    std::vector<std::string> names;
    for (const std::string& material : value) names.push_back(in_quotes(material));
    add(name, "names of materials", "[" + joined(names) + "]", {}, text);
  }
  void require(bool, std::string_view, std::string_view) override {}

 protected:
  ~Describer() = default;

  void add(std::string_view name, std::string type, std::string fallback, Range range, std::string_view text) {
    found.push_back({printable(name), std::move(type), printable(fallback), to_text(range), printable(range.unit),
                     printable(text, 2000)});
  }

 private:
  static std::string in_quotes(std::string_view text) { return '"' + std::string(text) + '"'; }
  static std::string quoted(std::initializer_list<std::string_view> options) {
    std::vector<std::string> names;
    for (const std::string_view option : options) names.push_back(in_quotes(option));
    return printable(joined(names), 2000);
  }
};

/// Describes the parameters of an operator in the order of their declaration. All of them must still have their default
/// values.
std::vector<ParameterDescription> describe_parameters(Operator& op);
/// Creates an operator and describes its parameters.
std::vector<ParameterDescription> describe_parameters(const AvailableOperator& available);

}  // namespace evodevo
