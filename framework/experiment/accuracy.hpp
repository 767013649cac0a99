// The dial between speed and accuracy.
#pragma once

#include "experiment/settings.hpp"

namespace evodevo {

/// How a body's steps are made, and how long they are.
struct Steps {
  Stepping stepping;
  StepRule step;
};

/// What `[simulation] accuracy` stands for where the file says nothing else. `paper` is the default. The others take
/// each body's own step, and lie on the front that the accuracy study measured (experiments/results/accuracy): `fast`
/// is the cheapest setting that still ranks robots; with contact shorter steps buy more than better methods, so
/// `balanced` takes three of them for one, and by a method of second order, which for the same price is right where
/// nothing touches; `reference` adds fourth order and double precision.
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
