// The dial between speed and accuracy.
#pragma once

#include <array>
#include <string_view>

#include "core/simulator.hpp"
#include "experiment/time_steps.hpp"

namespace evodevo {

/// What `[simulation] accuracy` chooses where the file says nothing else.
struct Accuracy {
  std::string_view name;
  Stepping stepping;
  StepRule step;
};

/// `paper` is the default. The others take each body's own step, and lie on the front that the accuracy study measured
/// (experiments/results/accuracy): `fast` is the cheapest setting that still ranks robots; with contact shorter steps
/// buy more than better methods, so `balanced` takes three of them for one, and by a method of second order, which for
/// the same price is right where nothing touches; `reference` adds fourth order and double precision.
inline constexpr std::array<Accuracy, 4> accuracies = {{
    {"paper", {Method::paper_euler, Precision::float32}, {.dt = 0.0005}},
    {"fast", {Method::symplectic_euler, Precision::float32}, {.dt = std::nullopt}},
    {"balanced", {Method::velocity_verlet, Precision::float32}, {.dt = std::nullopt, .refine = 3}},
    {"reference", {Method::rk4, Precision::float64}, {.dt = std::nullopt, .refine = 4}},
}};

}  // namespace evodevo
