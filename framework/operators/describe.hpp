// Describes the parameters that an operator declares.
#pragma once

#include <string>
#include <vector>

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

/// Collects the descriptions of declared parameters.
class Describer final : public Parameters {
 public:
  std::vector<ParameterDescription> found;

  void declare(const Parameter& parameter) override;
  void require(bool, std::string_view, std::string_view) override {}
};

/// Describes the parameters of an operator in the order of their declaration. All of them must still have their default
/// values.
std::vector<ParameterDescription> describe_parameters(Operator& op);
/// Creates an operator and describes its parameters.
std::vector<ParameterDescription> describe_parameters(const AvailableOperator& available);

}  // namespace evodevo
