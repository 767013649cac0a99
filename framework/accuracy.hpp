// The dial between speed and accuracy.
#pragma once

#include <array>
#include <string_view>

#include "simulator.hpp"
#include "time_steps.hpp"

namespace evodevo {

/// What `[simulation] accuracy` chooses where the file says nothing else.
struct Accuracy {
  std::string_view name;
  Stepping stepping;
  StepRule step;
};

/// `paper` is the default. The others take each body's own step: `fast` with the one method of first order that any
/// step leaves its terminal velocity, `balanced` with a second force at no more cost, of second order where nothing
/// touches the floor, `reference` with four forces a step, of fourth order, and steps short enough that contact, of
/// first order with every method, errs four times less.
inline constexpr std::array<Accuracy, 4> accuracies = {{
    {"paper", {Method::paper_euler, Precision::float32}, {.dt = 0.0005}},
    {"fast", {Method::symplectic_euler, Precision::float32}, {.dt = std::nullopt}},
    {"balanced", {Method::velocity_verlet, Precision::float32}, {.dt = std::nullopt}},
    {"reference", {Method::rk4, Precision::float64}, {.dt = std::nullopt, .refine = 4}},
}};

}  // namespace evodevo
