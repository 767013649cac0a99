// Writes down what an operator declares.
#pragma once

#include <string>
#include <vector>

#include "evodevo/operator.hpp"

namespace evodevo {

struct AvailableOperator;

/// One declared parameter in words.
struct ParameterDescription {
  std::string name;
  std::string type;      ///< "number", "whole number", "true or false", "option", …
  std::string fallback;  ///< the default, as TOML writes it
  std::string allowed;   ///< range or options; empty where anything of the type goes
  std::string unit;
  std::string text;
};

/// The parameters of an operator that still has its defaults, in the order of their declaration.
std::vector<ParameterDescription> describe_parameters(Operator& op);
/// The same of a new operator.
std::vector<ParameterDescription> describe_parameters(const AvailableOperator& available);

}  // namespace evodevo
