// The setting `accuracy`: a choice between fast and accurate simulation.
#pragma once

#include "experiment/settings.hpp"

namespace evodevo {

/// How time steps are computed, and how long they are.
struct Steps {
  Stepping stepping;
  StepRule step;
};

/// Returns the values of those keys of [simulation] that the file leaves out. `paper` is the default and has the
/// paper's time step. With the other values, each body has its own time step; these settings lie on the Pareto front of
/// speed and accuracy that the accuracy study measured (experiments/results/accuracy). `fast` is the cheapest setting
/// that still ranks robots correctly. `balanced` divides each step by three, because in contact with the floor shorter
/// steps reduce the error more than better methods do; it uses a second-order method, which costs no more and is
/// accurate without contact. `reference` divides each step by four and uses a fourth-order method in double precision.
inline Steps steps_of(Accuracy accuracy) {
  switch (accuracy) {
    case Accuracy::fast:
      return {{Method::symplectic_euler, Precision::float32}, {.dt = std::nullopt}};
    case Accuracy::balanced:
      return {{Method::velocity_verlet, Precision::float32}, {.dt = std::nullopt, .refine = 3}};
    case Accuracy::reference:
      return {{Method::rk4, Precision::float64}, {.dt = std::nullopt, .refine = 4}};
    case Accuracy::paper:
      break;
  }
  return {{Method::paper_euler, Precision::float32}, {.dt = 0.0005}};
}

}  // namespace evodevo
