// What the host and the device say to each other: plain structures that both compilers lay out alike.
#pragma once

#include <cstdint>

#include "cuda/layout/fixed_point.hpp"
#include "physics/energy_bound.hpp"

namespace evodevo::cuda {

inline constexpr unsigned lanes = 32;            ///< threads of a warp, banks of shared memory
inline constexpr unsigned guard_interval = 100;  ///< steps between two checks of a body

/// Masses lie in shared memory in groups of 32, one to a bank: six planes of 32 numbers, the places x, y, z and the
/// forces x, y, z. All six are then at a constant distance of each other, whatever the size of the body.
template <class T>
inline constexpr unsigned plane_bytes = lanes * sizeof(T);
template <class T>
inline constexpr unsigned group_bytes = 6 * plane_bytes<T>;

/// A spring as its owner's thread sees it.
template <class T>
struct alignas(2 * sizeof(T)) Record {
  T rest_length;  ///< m
  typename FixedPoint<T>::Integer
      packed;  ///< low 16 bits: offset of the other mass; next 16 bits: of the table's entry; each in bytes or numbers;
               ///< or MaterialCode::stiffness instead of the entry
};

/// What a material does in one step; stiffness and force in units of the body's force resolution.
template <class T>
struct alignas(2 * sizeof(T)) Entry {
  T stiffness;   ///< k, 1/m
  T rest_force;  ///< k L(t)/L0, 1/m
};

/// A material over time.
struct Actuator {
  double stiffness;  ///< as in Entry
  double amplitude;  ///< 1
  double frequency;  ///< Hz
  double phase;      ///< in half group_ends
};

/// What the numbers in the codes of a body's computed materials count (material_code.hpp).
template <class T>
struct CodeUnits {
  T stiffness;          ///< as in Entry
  T amplitude;          ///< 1, of the code's bits in place
  T angular_frequency;  ///< rad/s
  double frequency;     ///< Hz
};

/// The scene and a body's step in the arithmetic of the simulation. What paper-euler reads comes first, some in pairs.
template <class T>
struct StepConstants {
  T acceleration;      ///< of gravity along -z, m/s^2
  T floor_stiffness;   ///< N/m
  T friction_dt;       ///< friction coefficient times dt, s
  T drag_coefficient;  ///< kg/m
  T decay;             ///< exp(-damping rate dt): what damping leaves of a velocity
  T dt;                ///< s
  T damped_dt;         ///< (1 - decay)/rate, s: what a constant acceleration adds to it meanwhile
  T half_decay;        ///< both for half a step
  T half_damped_dt;    ///< s
  T damping_rate;      ///< 1/s
  T grade;             ///< Gravity::grade()
  T roughness;         ///< m
  T cells;             ///< of rough ground, in a metre
  std::uint32_t seed;  ///< Floor::first_line()
  double exact_dt;     ///< s
};

/// Where a run stands that may be a piece of one: Course.
struct RunPiece {
  double origin;             ///< State::time where the whole run began, s
  std::uint64_t first_step;  ///< that the whole run had made before
  std::uint64_t steps;       ///< to make
  EnergyBound bound;
  std::uint32_t since_check;  ///< steps, where this piece begins
  std::uint32_t is_last;      ///< whether the whole run ends with this piece
  std::uint32_t left_range;   ///< whether a force has left the range since the last check
};

/// How a body's run ended and its energies then.
struct Answer {
  std::uint64_t steps;  ///< that were made
  double kinetic;       ///< J
  double elastic;       ///< J
  double fallen;        ///< Course::fallen, from before the run on, J
  double work;          ///< J
  std::uint32_t diverged, finite, out_of_range;
};

/// A body in motion, one entry for each place; places that hold no mass weigh nothing and never move.
template <class T>
struct Motion {
  T *x, *y, *z;     ///< m
  T *vx, *vy, *vz;  ///< m/s
};

/// A body whose state stays on the chip: resident.cu.
template <class T>
struct ResidentBody {
  using Integer = typename FixedPoint<T>::Integer;
  StepConstants<T> constants;
  CodeUnits<T> units;                ///< where materials are computed
  const Record<T>* records;          ///< [warps][chunks][rows][lanes]
  const std::uint32_t* waves;        ///< likewise, MaterialCode::wave where materials are computed
  const std::uint32_t* first_group;  ///< [block's warps] whose masses a warp's first row belongs to
  const std::uint32_t* group_ends;   ///< [block's warps][chunks] bit r: the next group begins after row r
  const Actuator* actuators;         ///< [entries]; entry 0 is no material
  const T* mass;                     ///< [padded masses] kg
  const T* inverse_mass;             ///< [padded masses] 1/kg, 0 for what never moves
  const Integer* start;              ///< [padded masses] what a force sum starts from, so that the magic numbers cancel
  Motion<T> motion;                  ///< [padded masses]
  double* stress;                    ///< [slots] sum of |force|, N
  T* recent_stress;                  ///< [slots] of it what is not yet in `stress`, units; where chunked
  // [slots] where they are recorded, by reductions that nobody waits for; a slot has one writer
  Integer* peak;     ///< bits of the largest |force|, units: those of numbers that are not negative rise with them
  double* powers;    ///< sum of power, units m/s
  double* tensions;  ///< sum of force, units
  Answer* answer;
  RunPiece piece;
  double resolution;                             ///< N, a power of two
  T largest_force;                               ///< units of the resolution; a larger one leaves the range
  std::uint32_t groups, warps, chunks, entries;  ///< warps: that have springs
  std::uint32_t table_steps;                     ///< steps that the table in shared memory holds
  std::uint32_t table_offset;                    ///< bytes from the beginning of shared memory
  std::uint32_t rate_offset;                     ///< likewise, of the rates, where work is recorded
  std::uint32_t record_offset;                   ///< likewise, of the records
  std::uint32_t wave_offset;                     ///< likewise, of the waves
};

/// A spring at one of its ends.
template <class T>
struct alignas(4 * sizeof(T)) Joint {
  T rest_length;        ///< m
  std::uint32_t other;  ///< the mass at the other end
  std::uint32_t entry;  ///< of the table
  std::uint32_t owned;  ///< whether this end counts for what is summed once per spring
};

/// A spring as a method sees it that goes through the springs by colour.
template <class T>
struct ColouredSpring {
  T rest_length;        ///< m
  std::uint32_t a, b;   ///< the masses
  std::uint32_t entry;  ///< of the table
  std::uint32_t joint;  ///< where its stress is summed up
};

template <class T>
struct alignas(4 * sizeof(T)) Point {
  T x, y, z, unused;
};

/// A body that is too large for the chip (streamed.cu) or whose method has no kernel there. Its masses lie by falling
/// number of springs, so that those of a group have about as many.
template <class T>
struct StreamedBody {
  StepConstants<T> constants;
  const std::uint32_t* first_row;        ///< [groups of 32 masses + 1]
  const Joint<T>* joints;                ///< [rows][lanes]; a mass's joints are in the rows of its group, in its lane
  const ColouredSpring<T>* coloured;     ///< by colour (spring_colours()); where the method asks for them
  const std::uint32_t* first_of_colour;  ///< [colours + 1] among them
  const Actuator* actuators;             ///< [entries]; stiffness in N/m
  const T* mass;                         ///< [masses] kg
  const T* inverse_mass;                 ///< [masses] 1/kg, 0 for what never moves
  Point<T>* positions;                   ///< [2][masses] m; a pass reads one half and writes the other
  Point<T>* velocities;                  ///< [masses] m/s
  T* scratch;                            ///< the method's own, 16 bytes aligned
  Entry<T>* table;                       ///< [rows][entries] from one check to the next
  T* rates;                              ///< [rows][entries] rate of L/L0, 1/s; where work is recorded
  double* stress;                        ///< [rows][lanes] sum of |force|, N, at owned joints
  double* power;                         ///< [masses] sum of power, W; where work is recorded
  // at owned joints, where they are recorded
  T* peak;           ///< [rows][lanes] largest |force|, N
  double* powers;    ///< [rows][lanes] sum of power, W
  double* tensions;  ///< [rows][lanes] sum of force, N
  Answer* answer;
  RunPiece piece;
  std::uint32_t masses, entries, colours;
  std::uint32_t on_chip;  ///< whether MethodForm::points_on_chip lie in shared memory
};

}  // namespace evodevo::cuda
