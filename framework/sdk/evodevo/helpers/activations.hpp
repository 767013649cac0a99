// The activation functions of compositional pattern-producing networks (Stanley 2007).
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

namespace evodevo {

/// A function that a neuron may have.
struct Activation {
  std::string_view name;
  double (*value)(double);
};

/// The functions that a neuron may have. The value of each is of the order of 1 if its argument is.
inline constexpr std::array<Activation, 5> activations = {{
    {"linear", [](double x) { return x; }},
    {"tanh", [](double x) { return std::tanh(x); }},
    {"sine", [](double x) { return std::sin(x); }},
    {"gaussian", [](double x) { return std::exp(-x * x); }},
    {"absolute", [](double x) { return std::abs(x); }},
}};

/// Returns the names of `activations`, for the genes that choose among them.
inline std::vector<std::string> activation_names() {
  std::vector<std::string> names;
  for (const Activation& activation : activations) names.emplace_back(activation.name);
  return names;
}

}  // namespace evodevo
