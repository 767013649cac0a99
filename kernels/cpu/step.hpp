// The interface between portable code (run.cpp) and code that is compiled once per instruction set (step.cpp).
//
//   Kernels::actuate      material parameters, times ─► tables of relative lengths
//   Integrator::advance   Motion, StepConstants, tables ─► Motion after some steps
//   Kernels::energies     Motion, lengths now ─► Energies, for the guard
//
// Only plain data and raw pointers cross this interface. If both sides instantiated the same inline function of the
// standard library, the linker could keep the copy with instructions that not every processor has.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/method.hpp"
#include "cpu/layout.hpp"

namespace evodevo::cpu {

/// A time interval, which is a step or half a step.
template <class T>
struct TimeSpan {
  T dt;         ///< s
  T decay;      ///< exp(-damping rate dt): the fraction of a velocity that damping leaves
  T damped_dt;  ///< (1 - decay)/rate, s: a constant acceleration a adds a damped_dt to a damped velocity in dt
};

/// The constants of a step: the scene and the step length as numbers of type T. Disabled forces are not computed.
template <class T>
struct StepConstants {
  bool gravity, slope, floor, rigid, rough, friction, static_friction, drag, damping;  ///< rigid implies floor
  T acceleration;      ///< acceleration of gravity along -z, m/s^2
  T grade;             ///< Gravity::grade()
  T floor_stiffness;   ///< of an elastic floor, N/m
  T restitution;       ///< of a rigid floor
  T roughness;         ///< m
  T cells;             ///< number of cells of rough ground per metre, 1/m
  std::uint32_t seed;  ///< Floor::first_line()
  T friction_coefficient, static_coefficient;
  T drag_coefficient;  ///< kg/m
  T damping_rate;      ///< 1/s
  TimeSpan<T> step, half_step;
};

/// The quantities that are summed for each slot during the steps.
struct Sums {
  bool force = false;    ///< |force|, whose mean over the steps is the stress
  bool power = false;    ///< power that the muscle puts into the body
  bool peak = false;     ///< the largest |force|
  bool tension = false;  ///< force, positive if the spring pulls
};

/// ColouredSprings as raw pointers.
template <class T>
struct ColouredView {
  std::size_t size;
  const std::uint32_t *a, *b, *slot;
  const T *stiffness, *rest_length, *inverse_mass_a, *inverse_mass_b;
  const T* damping;  ///< null if no spring has a dashpot
  const Index<T>* material;
};

/// One body in motion, as raw pointers. All arrays of masses are padded to whole groups with masses of inverse mass 0.
template <class T>
struct Motion {
  // springs, as in Layout
  std::size_t groups;
  const std::uint32_t* first_row;
  const std::uint32_t* neighbour;
  const T* stiffness;
  const T* rest_length;
  const T* damping;  ///< null if no spring has a dashpot
  const Index<T>* material;
  ColouredView<T> coloured;  ///< only if Integrator::coloured

  const T* mass;              ///< kg
  const T* inverse_mass;      ///< 1/kg; 0 for masses that never move
  T *x, *y, *z;               ///< m
  T* interleaved_positions;   ///< a copy of x, y, z that neighbours read: position_stride numbers per mass, m
  T *vx, *vy, *vz;            ///< m/s
  T* interleaved_velocities;  ///< velocities at which dashpots act, like the positions, m/s; null without dashpots
  T *fx, *fy, *fz;            ///< N
  T* floor_force;             ///< normal force of an elastic floor, on rough ground its vertical part, N
  T* arrival;                 ///< of a rigid floor: rise of each mass at the beginning of a step, m/s
  T* push;                    ///< velocity that a rigid floor has added in a step along its unit normal, m/s
  T* mass_scratch;            ///< Integrator::mass_arrays arrays, one number for each mass
  T* slot_scratch;            ///< Integrator::slot_arrays arrays, one number for each slot
  std::size_t slots;

  // [slots]; null if not enabled in Sums
  T* force_sum;    ///< N
  T* power_sum;    ///< W
  T* peak;         ///< N
  T* tension_sum;  ///< N

  T* contact_steps;  ///< [masses] number of steps in which each mass touched the ground; null if not counted
};

/// The materials as arrays of `padded` entries, and tables of their relative lengths with one row for each time.
template <class T>
struct Actuation {
  std::size_t materials, padded;
  const double *amplitude, *frequency, *phase;
  T* relative_length;  ///< [row][padded] L(t)/L0
  T* relative_rate;    ///< [row][padded] its rate of change, 1/s; null if Sums::power is off
};

struct Energies {
  double kinetic, elastic;  ///< J
  double height_moment;     ///< sum of mass times height over all masses, kg m
  bool finite;              ///< whether all positions and velocities are finite
};

/// A time-stepping method.
template <class T>
struct Integrator {
  std::size_t rows_per_step;  ///< rows of the tables per step
  std::size_t mass_arrays;    ///< scratch arrays, one number per mass each; their content is not kept between calls
  std::size_t slot_arrays;    ///< scratch arrays, one number per slot each
  bool coloured;              ///< whether the method needs the springs by colour
  /// Advances the body by `steps` steps. `actuation` holds the relative lengths from the beginning of the first step to
  /// the end of the last step.
  void (*advance)(const Motion<T>&, const StepConstants<T>&, const Actuation<T>& actuation, std::size_t steps, Sums);
};

/// The functions of one instruction set for one precision.
template <class T>
struct Kernels {
  const char* instruction_set;
  std::size_t lanes;
  std::size_t table_size;  ///< Actuation::padded is a multiple of this

  /// Fills `rows` rows of the tables, for the times start + first dt, start + (first + 1) dt, .. (s).
  void (*actuate)(const Actuation<T>&, double start, std::uint64_t first, std::size_t rows, double dt);
  Integrator<T> integrator[method_names.size()];  ///< one for each Method
  /// Returns the current energies; row 0 of the tables must hold the current relative lengths.
  Energies (*energies)(const Motion<T>&, const StepConstants<T>&, const Actuation<T>& actuation);
};

/// The functions for the best instruction set that this processor has.
template <class T>
const Kernels<T>& kernels();

}  // namespace evodevo::cpu
