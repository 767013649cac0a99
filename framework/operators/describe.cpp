#include "operators/describe.hpp"

#include "base/text.hpp"
#include "operators/loader.hpp"

namespace evodevo {
namespace {

constexpr std::size_t longest_text = 2000;  ///< of a sentence or a list of options, in bytes

std::string in_quotes(std::string_view text) { return '"' + std::string(text) + '"'; }

template <class Texts>
std::string quoted(const Texts& texts) {
  std::vector<std::string> quotes;
  for (const auto& text : texts) quotes.push_back(in_quotes(text));
  return joined(quotes);
}

std::string value_text(double value) { return to_text(value); }
std::string value_text(std::int64_t value) { return std::to_string(value); }

template <class Numbers>
std::string list(const Numbers& numbers) {
  std::vector<std::string> texts;
  for (const auto number : numbers) texts.push_back(value_text(number));
  return "[" + joined(texts) + "]";
}

std::string list(const Vec3& v) { return list(std::array{v.x, v.y, v.z}); }

/// The type of a variable, and its value as in a TOML file.
struct Told {
  std::string type, value;
};

Told told(const parameter::Real& real) { return {"number", to_text(real.value)}; }
Told told(const parameter::Integer& integer) { return {"whole number", std::to_string(integer.value)}; }
Told told(const parameter::Flag& flag) { return {"true or false", flag.value ? "true" : "false"}; }
Told told(const parameter::Choice& choice) { return {"option", in_quotes(choice.value)}; }
Told told(const parameter::Vector& vector) { return {"three numbers", list(vector.value)}; }
Told told(const parameter::VectorOrChoice& either) {
  return {"three numbers or option", either.word.empty() ? list(either.value) : in_quotes(either.word)};
}
Told told(const parameter::Counts& counts) { return {"three whole numbers", list(counts.value)}; }
Told told(const parameter::OptionalReal& real) {
  const std::string none = real.none.empty() ? "none" : in_quotes(real.none);
  return {real.none.empty() ? "number" : none + " or a number", real.value ? to_text(*real.value) : none};
}
Told told(const parameter::Reals& reals) { return {"list of numbers", list(reals.value)}; }
Told told(const parameter::Text& text) { return {"text", in_quotes(text.value)}; }
Told told(const parameter::File& file) {
  return {"file", file.value.path.empty() ? "none" : in_quotes(file.value.path)};
}
Told told(const parameter::Materials& materials) { return {"names of materials", "[" + quoted(materials.value) + "]"}; }

}  // namespace

void Describer::declare(const Parameter& parameter) {
  std::visit(
      [&](const auto& variable) {
        const auto [type, value] = told(variable);
        ParameterDescription description{
            printable(parameter.name), type, printable(value), "", "1", printable(parameter.text, longest_text)};
        if constexpr (requires { variable.range; }) {
          description.allowed = to_text(variable.range);
          description.unit = printable(variable.range.unit);
        }
        if constexpr (requires { variable.options; }) {
          if (!description.allowed.empty()) description.allowed += ", or ";
          description.allowed += printable(quoted(variable.options), longest_text);
        }
        found.push_back(std::move(description));
      },
      parameter.variable);
}

std::vector<ParameterDescription> describe_parameters(Operator& op) {
  Describer describer;
  op.parameters(describer);
  return std::move(describer.found);
}

std::vector<ParameterDescription> describe_parameters(const AvailableOperator& available) {
  return in_operator({available.title}, [&] { return describe_parameters(*create<Operator>(available)); });
}

}  // namespace evodevo
