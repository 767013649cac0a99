// The classical Runge-Kutta method of fourth order: kernels/cpu/methods/rk4-inl.hpp.
#pragma once

#include "cuda/device/mass_step.cuh"

namespace evodevo::cuda {

/// A pass is a stage.
struct Method : OnePass {
  struct Kept {
    Place place, velocity;  ///< at the beginning of the step
    Place mean_velocity, mean_acceleration;
    Number mean_push;  ///< of the floor, N
  };

  /// The two stages in the middle of a step share the row there; its end is the beginning of the next.
  static __device__ __forceinline__ unsigned row(unsigned index) { return index / 4 * 2 + (index % 4 + 1) / 2; }
  static __device__ __forceinline__ bool is_noted(unsigned index) { return index % 4 == 0; }

  static __device__ __forceinline__ void move(const World<Number>& world, Pass pass, Kept& kept, Moving& m) {
    const unsigned stage = pass.index % 4;
    if (stage == 0) kept = {m.place, m.velocity, {0, 0, 0}, {0, 0, 0}, 0};
    add_gravity(world, m);
    add_floor(world, m);
    add_drag(world, m);
    add_damping(world, m);
    add_to_means(Number(1) / (stage == 0 || stage == 3 ? 6 : 3), m, kept);
    if (stage < 3)
      go_ahead(stage == 2 ? world.dt : world.dt / 2, kept, m);
    else
      finish(world, kept, m);
  }

 private:
  static __device__ __forceinline__ void add_to_means(Number share, const Moving& m, Kept& kept) {
    kept.mean_velocity = sum(kept.mean_velocity, share, m.velocity);
    kept.mean_acceleration = sum(kept.mean_acceleration, share, scaled(m.force, m.inverse_mass));
    if constexpr (friction) kept.mean_push = physics::multiply_add(share, m.push, kept.mean_push);
  }

  /// To where the velocity and the acceleration of this stage lead from the beginning of the step in `time` s.
  static __device__ __forceinline__ void go_ahead(Number time, const Kept& kept, Moving& m) {
    m.place = sum(kept.place, time, m.velocity);
    m.velocity = sum(kept.velocity, time * m.inverse_mass, m.force);
  }

  /// The end of the step. Friction takes half as much of the mean velocity as of the last.
  static __device__ __forceinline__ void finish(const World<Number>& world, Kept& kept, Moving& m) {
    m.velocity = sum(kept.velocity, world.dt, kept.mean_acceleration);
    m.push = kept.mean_push;
    rub(world.friction_dt, m, m.velocity);
    rub(world.friction_dt / 2, m, kept.mean_velocity);
    m.place = sum(kept.place, world.dt, kept.mean_velocity);
  }
};

}  // namespace evodevo::cuda
