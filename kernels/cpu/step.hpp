// The border between code for any processor and code compiled once per instruction set. What crosses it is plain data
// and raw pointers: an inline function of the standard library that both sides instantiate could end up in the binary
// with instructions that not every processor has.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/method.hpp"
#include "cpu/layout.hpp"

namespace evodevo::cpu {

/// A step or a part of one.
template <class T>
struct TimeSpan {
  T dt;         ///< s
  T decay;      ///< exp(-damping rate dt): what damping leaves of a velocity
  T damped_dt;  ///< (1 - decay)/rate, s: what a constant acceleration adds to it meanwhile
};

/// The scene and the step in the arithmetic of the simulation; a force that is off is not computed.
template <class T>
struct StepConstants {
  bool gravity, slope, floor, rough, friction, drag, damping;
  T acceleration;      ///< of gravity along -z, m/s^2
  T grade;             ///< Gravity::grade()
  T floor_stiffness;   ///< N/m
  T roughness;         ///< m
  T cells;             ///< of rough ground, in a metre
  std::uint32_t seed;  ///< Floor::first_line()
  T friction_coefficient;
  T drag_coefficient;  ///< kg/m
  T damping_rate;      ///< 1/s
  TimeSpan<T> step, half_step;
};

/// What is added up for each slot during the steps.
struct Sums {
  bool force = false;    ///< |force|, for stress
  bool power = false;    ///< power of actuation
  bool peak = false;     ///< the largest |force|
  bool tension = false;  ///< force, positive where the spring pulls
};

/// ColouredSprings, as arrays.
template <class T>
struct ColouredView {
  std::size_t size;
  const std::uint32_t *a, *b, *slot;
  const T *stiffness, *rest_length, *inverse_mass_a, *inverse_mass_b;
  const Index<T>* material;
};

/// One body in motion, as arrays. All arrays of masses are padded to whole groups with masses that nothing moves.
template <class T>
struct Motion {
  // springs, as in Layout
  std::size_t groups;
  const std::uint32_t* first_row;
  const std::uint32_t* neighbour;
  const T* stiffness;
  const T* rest_length;
  const Index<T>* material;
  ColouredView<T> coloured;  ///< where Integrator::coloured asks for it

  const T* mass;             ///< kg
  const T* inverse_mass;     ///< 1/kg; 0 for what never moves
  T *x, *y, *z;              ///< m
  T* interleaved_positions;  ///< x, y, z again, position_stride numbers a mass, for neighbours to read
  T *vx, *vy, *vz;           ///< m/s
  T *fx, *fy, *fz;           ///< N
  T* floor_force;            ///< N
  T* mass_scratch;           ///< Integrator::mass_arrays arrays, one number for each mass
  T* slot_scratch;           ///< Integrator::slot_arrays arrays, one number for each slot
  std::size_t slots;

  // [slots]; null where Sums does not ask for them
  T* force_sum;    ///< N
  T* power_sum;    ///< W
  T* peak;         ///< N
  T* tension_sum;  ///< N
};

/// Materials in arrays, padded to `padded`, and what they do at each of some times.
template <class T>
struct Actuation {
  std::size_t materials, padded;
  const double *amplitude, *frequency, *phase;
  T* relative_length;  ///< [row][padded] L(t)/L0
  T* relative_rate;    ///< [row][padded] its rate of change, 1/s; null where Sums::power is off
};

struct Energies {
  double kinetic, elastic;  ///< J
  double height_moment;     ///< sum of mass times height, kg m
  bool finite;              ///< whether all places and velocities are
};

/// A time-stepping method.
template <class T>
struct Integrator {
  std::size_t rows_per_step;  ///< rows of the tables that time advances by in a step
  std::size_t mass_arrays;    ///< memory of its own; what it holds need not outlive a call
  std::size_t slot_arrays;
  bool coloured;  ///< whether it needs the springs by colour
  /// Moves the body by `steps` steps; `actuation` holds the relative lengths from their beginning to their end.
  void (*advance)(const Motion<T>&, const StepConstants<T>&, const Actuation<T>& actuation, std::size_t steps, Sums);
};

/// The functions of one instruction set for one precision.
template <class T>
struct Kernels {
  const char* instruction_set;
  std::size_t lanes;
  std::size_t table_size;  ///< Actuation::padded is a multiple of this

  /// Fills in `rows` rows of the tables: for the times start + first dt, start + (first + 1) dt, ..
  void (*actuate)(const Actuation<T>&, double start, std::uint64_t first, std::size_t rows, double dt);
  Integrator<T> integrator[method_names.size()];  ///< by Method
  /// The energies now, with the relative lengths of the table's row 0.
  Energies (*energies)(const Motion<T>&, const StepConstants<T>&, const Actuation<T>& actuation);
};

/// The functions for the best instruction set that this processor has.
template <class T>
const Kernels<T>& kernels();

}  // namespace evodevo::cpu
