#include "operators/declarations.hpp"

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "operators/host_keys.hpp"

namespace evodevo {
namespace {

class DeclarationCheck final : public Parameters {
 public:
  std::vector<std::string> wrong_defaults, required, taken_names, faults;

  void real(double& value, std::string_view name, Range range, std::string_view text) override {
    declare(name, text);
    check(name, value, range);
  }
  void integer(std::int64_t& value, std::string_view name, Range range, std::string_view text) override {
    declare(name, text);
    check(name, static_cast<double>(value), range);
  }
  void flag(bool&, std::string_view name, std::string_view text) override { declare(name, text); }
  void choice(std::string& value, std::string_view name, std::initializer_list<std::string_view> options,
              std::string_view text) override {
    declare(name, text);
    check_option(name, value, options);
  }
  void vector(Vec3& value, std::string_view name, Range range, std::string_view text) override {
    declare(name, text);
    for (const double part : {value.x, value.y, value.z}) check(name, part, range);
  }
  void vector_or_choice(Vec3& value, std::string& word, std::string_view name, Range range,
                        std::initializer_list<std::string_view> options, std::string_view text) override {
    vector(value, name, range, text);
    if (!word.empty()) check_option(name, word, options);
  }
  void counts(std::array<std::int64_t, 3>& value, std::string_view name, Range range, std::string_view text) override {
    declare(name, text);
    for (const std::int64_t part : value) check(name, static_cast<double>(part), range);
  }
  void optional_real(std::optional<double>& value, std::string_view name, Range range, std::string_view text) override {
    declare(name, text);
    check(name, value.value_or(range.low), range);
  }
  void reals(std::vector<double>& value, std::string_view name, Range range, std::string_view text) override {
    declare(name, text);
    check(name, range.low, range);
    for (const double number : value) check(name, number, range);
  }
  void text(std::string& value, std::string_view name, std::string_view text) override {
    declare(name, text);
    if (value.empty()) unset_.emplace_back(name);
  }
  void file(InputFile& value, std::string_view name, std::string_view text) override {
    declare(name, text);
    if (value.path.empty()) unset_.emplace_back(name);
  }
  void materials(std::vector<std::string>&, std::string_view name, std::string_view text) override {
    declare(name, text);
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
  void declare(std::string_view name, std::string_view text) {
    if (std::find(names_.begin(), names_.end(), name) != names_.end()) fault(name, "is declared twice");
    names_.emplace_back(name);
    if (host_key::is_reserved(name)) taken_names.emplace_back(name);
    if (name.empty()) fault(name, "has no name");
    if (text.size() <= 10 || !text.ends_with('.'))
      fault(name, "is not described by a sentence that ends with a full stop");
  }

  void check_option(std::string_view name, const std::string& value, std::initializer_list<std::string_view> options) {
    if (std::find(options.begin(), options.end(), value) == options.end())
      wrong_defaults.push_back(std::string(name) + " = \"" + value +
                               "\" is not one of its options; correct the default or the options");
  }

  void check(std::string_view name, double value, Range range) {
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
