// The activation functions of compositional pattern-producing networks (Stanley 2007).
#pragma once

#include <array>
#include <cmath>

namespace evodevo {

/// The functions that a neuron may have. The value of each is of the order of 1 if its argument is.
inline constexpr std::array<double (*)(double), 5> activations = {
    [](double x) { return x; },           [](double x) { return std::tanh(x); },
    [](double x) { return std::sin(x); }, [](double x) { return std::exp(-x * x); },
    [](double x) { return std::abs(x); },
};

}  // namespace evodevo
