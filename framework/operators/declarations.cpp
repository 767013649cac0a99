#include "operators/declarations.hpp"

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "operators/host_keys.hpp"

namespace evodevo {
namespace {

std::vector<double> numbers(double value) { return {value}; }
std::vector<double> numbers(std::int64_t value) { return {static_cast<double>(value)}; }
std::vector<double> numbers(const Vec3& value) { return {value.x, value.y, value.z}; }
std::vector<double> numbers(const std::array<std::int64_t, 3>& value) { return {value.begin(), value.end()}; }
std::vector<double> numbers(const std::optional<double>& value) {
  return value ? std::vector<double>{*value} : std::vector<double>{};
}
std::vector<double> numbers(const std::vector<double>& value) { return value; }

class DeclarationCheck final : public Parameters {
 public:
  std::vector<std::string> wrong_defaults, required, taken_names, faults;

  void declare(const Parameter& parameter) override {
    check_words(parameter.name, parameter.text);
    std::visit([&](const auto& variable) { check(parameter.name, variable); }, parameter.variable);
  }
  void require(bool holds, std::string_view name, std::string_view text) override {
    if (holds) return;
    if (std::find(unset_.begin(), unset_.end(), name) != unset_.end())
      required.emplace_back(name);
    else
      wrong_defaults.push_back(std::string(name) + ": " + std::string(text) +
                               "; correct the defaults or the requirement");
  }

 private:
  void check_words(std::string_view name, std::string_view text) {
    if (std::find(names_.begin(), names_.end(), name) != names_.end()) fault(name, "is declared twice");
    names_.emplace_back(name);
    if (host_key::is_reserved(name)) taken_names.emplace_back(name);
    if (name.empty()) fault(name, "has no name");
    if (text.size() <= 10 || !text.ends_with('.'))
      fault(name, "is not described by a sentence that ends with a full stop");
  }

  void check(std::string_view name, const parameter::Choice& choice) {
    check_option(name, choice.value, choice.options);
  }
  void check(std::string_view name, const parameter::VectorOrChoice& either) {
    check_numbers(name, numbers(either.value), either.range);
    if (!either.word.empty()) check_option(name, either.word, either.options);
  }
  void check(std::string_view name, const parameter::Text& text) {
    if (text.value.empty()) unset_.emplace_back(name);
  }
  void check(std::string_view name, const parameter::File& file) {
    if (file.value.path.empty()) unset_.emplace_back(name);
  }
  template <class Variable>
  void check(std::string_view name, const Variable& variable) {
    if constexpr (requires { variable.range; }) check_numbers(name, numbers(variable.value), variable.range);
  }

  void check_option(std::string_view name, const std::string& value, parameter::Options options) {
    if (std::find(options.begin(), options.end(), value) == options.end())
      wrong_defaults.push_back(std::string(name) + " = \"" + value +
                               "\" is not one of its options; correct the default or the options");
  }

  void check_numbers(std::string_view name, std::vector<double> values, Range range) {
    if (values.empty()) values = {range.low};  // so that a range without numbers is found
    for (const double value : values)
      // written so that NaN fails
      if (!(value >= range.low && value <= range.high))
        wrong_defaults.push_back(std::string(name) + " = " + to_text(value) + ", expected " + to_text(range) +
                                 "; correct the default or the range");
    if (!std::isfinite(range.low) || !std::isfinite(range.high)) fault(name, "has a range without finite bounds");
    if (range.unit.empty()) fault(name, "has no unit; the unit of a pure number is \"1\"");
  }

  void fault(std::string_view name, const std::string& what) {
    faults.push_back("parameter \"" + std::string(name) + "\" " + what);
  }

  std::vector<std::string> names_;
  std::vector<std::string> unset_;  ///< texts and files without a default
};

DeclarationCheck checked(Operator& op) {
  DeclarationCheck check;
  op.parameters(check);
  return check;
}

}  // namespace

std::string wrong_default(Operator& op) {
  const DeclarationCheck check = checked(op);
  return check.wrong_defaults.empty() ? "" : check.wrong_defaults.front();
}

std::string required_parameter(Operator& op) {
  const DeclarationCheck check = checked(op);
  return check.required.empty() ? "" : check.required.front();
}

std::string taken_name(Operator& op) {
  const DeclarationCheck check = checked(op);
  return check.taken_names.empty() ? "" : check.taken_names.front();
}

std::vector<std::string> declaration_faults(Operator& op) { return checked(op).faults; }

}  // namespace evodevo
