// The data that host and device exchange: plain structures that both compilers lay out in the same way.
#pragma once

#include <cstdint>

#include "cuda/layout/fixed_point.hpp"
#include "physics/energy_bound.hpp"

namespace evodevo::cuda {

inline constexpr unsigned lanes = 32;            ///< threads of a warp, banks of shared memory
inline constexpr unsigned guard_interval = 100;  ///< steps between two checks of a body

// Kernels unroll a loop over the rows of a warp. It ends after the body's number of rows, so that one kernel is for
// bodies of many sizes. If a warp has several chunks of rows, all of them are full.
inline constexpr unsigned most_rows = 24;  ///< unrolled, if a warp has one chunk
/// Likewise, if stress is recorded and this is enough, because each unrolled row has a sum of its own in a register.
inline constexpr unsigned rows_with_fast_stress = 16;
inline constexpr unsigned rows_of_a_chunk = 8;  ///< unrolled, if it has several
/// A warp reads the records of this many rows after its last, and the position of a mass that one of them names. They
/// may belong to another warp or another block; all blocks of a body have chips of one size, so they lie within it.
inline constexpr unsigned rows_read_ahead = 2;

/// Masses are in shared memory in groups of 32, one mass per bank. A group is six planes of 32 numbers: the positions
/// x, y, z and the forces x, y, z; if the body has dashpots, three more planes have the velocities at which they act.
/// So the numbers of a mass are at constant distances from each other for bodies of any size.
template <class T>
inline constexpr unsigned plane_bytes = lanes * sizeof(T);
template <class T, bool dashpots>
inline constexpr unsigned group_bytes = (dashpots ? 9 : 6) * plane_bytes<T>;

/// In a cluster, each block simulates a part of the body. A spring between two parts is computed in both, so a block
/// needs the positions of some masses of other parts: its halo. A group of 32 of these masses has two sets of planes,
/// because a pass reads one set while the blocks of these masses already write the other. A set is the positions x, y,
/// z and, with dashpots, the velocities at which they act.
template <class T, bool dashpots>
inline constexpr unsigned halo_set_bytes = (dashpots ? 6 : 3) * plane_bytes<T>;
template <class T, bool dashpots>
inline constexpr unsigned halo_group_bytes = 2 * halo_set_bytes<T, dashpots>;

/// A spring in the format that the thread of its owner reads.
template <class T>
struct alignas(2 * sizeof(T)) Record {
  T rest_length;  ///< m
  typename FixedPoint<T>::Integer
      packed;  ///< low 16 bits: offset of the other mass; next 16 bits: offset of the table's entry, or
               ///< MaterialCode::stiffness; offsets count bytes or numbers (ResidentForm)
};

/// A mass of a block that is in the halo of another block.
struct HaloCopy {
  std::uint32_t from;  ///< offset of the mass in the shared memory of its own block, bytes
  std::uint32_t to;    ///< low 24 bits: offset of the copy's first set, bytes; above: rank of its block in the cluster
};
inline constexpr std::uint32_t halo_rank_shift = 24;

/// A material at one time; stiffness and force are in units of the body's force resolution.
template <class T>
struct alignas(2 * sizeof(T)) Entry {
  T stiffness;   ///< k, 1/m
  T rest_force;  ///< k L(t)/L0, 1/m
};

/// A material as a function of time.
struct Actuator {
  double stiffness;  ///< as in Entry
  double amplitude;  ///< 1
  double frequency;  ///< Hz
  double phase;      ///< half turns
};

/// The units of the numbers in the codes of a body's computed materials (physics/material_code.hpp).
template <class T>
struct CodeUnits {
  T stiffness;          ///< as in Entry
  T amplitude;          ///< 1; factor for the code's word with only the amplitude's bits set
  T angular_frequency;  ///< rad/s
  double frequency;     ///< Hz
};

/// The constants of a step: the scene and a body's step length as numbers of type T. Those that paper-euler reads come
/// first, ordered so that some are read in pairs.
template <class T>
struct StepConstants {
  T acceleration;      ///< acceleration of gravity along -z, m/s^2
  T floor_stiffness;   ///< of an elastic floor, N/m
  T friction_dt;       ///< friction coefficient times dt, s
  T drag_coefficient;  ///< kg/m
  T decay;             ///< exp(-damping rate dt): the fraction of a velocity that damping leaves
  T dt;                ///< s
  T damped_dt;         ///< (1 - decay)/rate, s: a constant acceleration a adds a damped_dt to a damped velocity in dt
  T half_decay;        ///< decay over half a step
  T half_damped_dt;    ///< s
  T damping_rate;      ///< 1/s
  T grade;             ///< Gravity::grade()
  T roughness;         ///< m
  T cells;             ///< number of cells of rough ground per metre, 1/m
  std::uint32_t seed;  ///< Floor::first_line()
  T restitution;       ///< of a rigid floor
  T friction_coefficient, static_coefficient;
  double exact_dt;  ///< s
};

/// The piece of a run that a task simulates, and the whole run's Course so far.
struct RunPiece {
  double origin;             ///< State::time at the beginning of the whole run, s
  std::uint64_t first_step;  ///< steps of the whole run before this piece
  std::uint64_t steps;       ///< steps of this piece
  EnergyBound bound;
  std::uint32_t since_check;  ///< steps between the last check and the beginning of this piece
  std::uint32_t is_last;      ///< whether the whole run ends with this piece
  std::uint32_t left_range;   ///< whether a force has left the range since the last check
};

/// How a body's piece of a run ended, and its energies at the last check.
struct Answer {
  std::uint64_t steps;  ///< number of steps simulated
  double kinetic;       ///< J
  double elastic;       ///< J
  double fallen;        ///< Course::fallen, including earlier pieces, J
  double work;          ///< J
  std::uint32_t diverged, finite, out_of_range;
};

// the channels of a sample, as bits
inline constexpr std::uint32_t centre_bit = 1, box_bit = 2, contact_bit = 4, work_bit = 8, positions_bit = 16,
                               velocities_bit = 32, contacts_bit = 64, forces_bit = 128;

/// A sample that the device takes. The reduced quantities are followed by the lists that the channels ask for:
/// positions and velocities as float [3][masses], contacts as std::uint32_t [masses], forces as float [slots or
/// joints].
struct SampleMark {
  std::uint64_t step;  ///< of the task, at least 1
  unsigned char* to;   ///< in the host's memory, aligned to 16 bytes
  std::uint32_t channels;
};

/// The reduced quantities of a sample.
struct ReducedSample {
  double centre[3];      ///< m
  double work;           ///< J
  double velocity[3];    ///< of the centre of mass, m/s
  double contact_steps;  ///< of all masses
  double low[4];         ///< the box, with opposite sign, m; the last number is unused
  double high[4];        ///< m
};

/// What the device needs to sample a body. It writes samples directly to the host's memory, whose room for a range of
/// check spans is used again for the next range but one.
struct Sampling {
  const SampleMark* marks;   ///< [count + 1] in ascending order of their steps; that of the last is never reached
  const double* mass_share;  ///< [masses of the part] share of a mass in the body's mass; below 0: padding, not a mass
  std::uint32_t*
      contact_steps;  ///< [masses of the part] number of steps after which each mass touched the ground, if counted
  std::uint64_t spans_per_range;
  std::uint32_t count, masses;
  std::uint32_t first_mass, first_slot;  ///< of a part, in the lists of the body
};

/// The components of a vector for each mass.
template <class T>
struct Triplets {
  T *x, *y, *z;
};

/// A body in motion: one entry for each mass, then padding that fills the last group. Padding has mass 0 and never
/// moves.
template <class T>
struct Motion {
  T *x, *y, *z;     ///< m
  T *vx, *vy, *vz;  ///< m/s
};

/// A body whose state stays on the chip, or the part of it that one block of a cluster simulates: resident.cu. Arrays
/// are those of the part.
template <class T>
struct ResidentBody {
  using Integer = typename FixedPoint<T>::Integer;
  StepConstants<T> constants;
  CodeUnits<T> units;          ///< if materials are computed
  const Record<T>* records;    ///< [warps][chunks][rows][lanes], [cut warps][chunks][cut rows][lanes], then the records
                               ///< of the next block or, after the last, rows_read_ahead empty rows
  const std::uint32_t* waves;  ///< likewise, MaterialCode::wave; if materials are computed
  const std::uint32_t* first_group;  ///< [block's warps] the group of each warp's first row
  const std::uint32_t* group_ends;   ///< [block's warps][chunks] bit r: a group or the warp's work ends with row r
  const Actuator* actuators;         ///< [entries]; entry 0 is for empty slots; unless materials are computed
  const T* coefficients;  ///< of the dashpots, units of force s/m: [entries] or, if materials are computed, like the
                          ///< records; if the body has any
  const T* mass;          ///< [padded masses] kg
  const T* inverse_mass;  ///< [padded masses] 1/kg; 0 for masses that never move
  const Integer* start;   ///< [padded masses] start value of a force sum, by which its magic numbers cancel
  Motion<T> motion;       ///< [padded masses]
  Triplets<T> dashpot_velocity;  ///< [padded masses] at which dashpots act next, m/s; if the body has any
  double* stress;                ///< [slots] sum of |force|, N
  T* recent_stress;              ///< [slots] the part of the sum that is not yet in `stress`, units; if chunked
  // [slots] if recorded; written by atomic operations that return no result, so that no thread waits; each slot has one
  // writer
  Integer* peak;     ///< bits of the largest |force|, units; as integers they have the same order as the forces
  double* powers;    ///< sum of power, units m/s
  double* tensions;  ///< sum of force, units
  Answer* answer;
  RunPiece piece;
  double resolution;                       ///< N, a power of two
  T largest_force;                         ///< units; a larger force leaves the range
  std::uint32_t groups, chunks, entries;   ///< numbers of each
  std::uint32_t warps;                     ///< warps with springs inside the part
  std::uint32_t cut_warps;                 ///< the warps after them: with springs between this part and others
  std::uint32_t rows, cut_rows;            ///< in each chunk of these warps
  std::uint32_t table_steps;               ///< steps for which the table in shared memory has rows
  std::uint32_t table_offset;              ///< of the table, bytes from the beginning of shared memory
  std::uint32_t rate_offset;               ///< of the rates, if work is recorded
  std::uint32_t coefficient_offset;        ///< of the coefficients of the dashpots
  std::uint32_t record_offset;             ///< of the records
  std::uint32_t wave_offset;               ///< of the waves
  std::uint32_t halo_offset;               ///< of the halo
  std::uint32_t halo_groups, halo_masses;  ///< numbers of each in the halo
  std::uint32_t copies;                    ///< number of `halo_copies`
  const HaloCopy* halo_copies;             ///< [copies]
  Sampling sampling;
};

/// One end of a spring.
template <class T>
struct alignas(4 * sizeof(T)) Joint {
  T rest_length;        ///< m
  std::uint32_t other;  ///< index of the mass at the other end
  std::uint32_t entry;  ///< index into a row of the table
  std::uint32_t owned;  ///< whether sums over springs count the spring at this end
};

/// A spring for a method that solves springs by colour.
template <class T>
struct ColouredSpring {
  T rest_length;        ///< m
  std::uint32_t a, b;   ///< indices of the masses
  std::uint32_t entry;  ///< index into a row of the table
  std::uint32_t joint;  ///< the joint at which its stress is summed
};

/// A position or velocity in the device's memory.
template <class T>
struct alignas(4 * sizeof(T)) Point {
  T x, y, z;
  T w;  ///< for what a method keeps beside the vector
};

/// A body that is too large for the chip (streamed.cu), or whose method keeps bodies in the device's memory (implicit,
/// xpbd). Its masses are sorted by descending degree (number of springs), so that the masses of a group have similar
/// numbers of springs.
template <class T>
struct StreamedBody {
  StepConstants<T> constants;
  const std::uint32_t* first_row;        ///< [groups of 32 masses + 1]
  const Joint<T>* joints;                ///< [rows][lanes]; a mass's joints are in the rows of its group, in its lane
  const ColouredSpring<T>* coloured;     ///< by colour (spring_colours()); if the method asks for them
  const std::uint32_t* first_of_colour;  ///< [colours + 1] index of each colour's first spring
  const Actuator* actuators;             ///< [entries]; stiffness in N/m
  const T* dashpots;                     ///< [entries] coefficient of the dashpots, N s/m; if the body has any
  const T* mass;                         ///< [masses] kg
  const T* inverse_mass;                 ///< [masses] 1/kg; 0 for masses that never move
  Point<T>* positions;                   ///< [2][masses] m; a pass reads one half and writes the other
  Point<T>* velocities;                  ///< [masses] m/s
  Point<T>* dashpot_velocities;          ///< [2][masses] at which dashpots act, like the positions; explicit methods
  T* scratch;                            ///< scratch memory of the method, aligned to 16 bytes
  Entry<T>* table;                       ///< [rows][entries] for the steps from one check to the next
  T* rates;                              ///< [rows][entries] rate of L/L0, 1/s; if work is recorded
  double* stress;                        ///< [rows][lanes] sum of |force|, N, at owned joints
  double* power;                         ///< [masses] sum of power, W; if work is recorded
  // at owned joints, if recorded
  T* peak;           ///< [rows][lanes] largest |force|, N
  double* powers;    ///< [rows][lanes] sum of power, W
  double* tensions;  ///< [rows][lanes] sum of force, N
  Answer* answer;
  RunPiece piece;
  std::uint32_t masses, entries, colours;
  std::uint32_t on_chip;  ///< whether MethodForm::points_on_chip are in shared memory
  Sampling sampling;
};

}  // namespace evodevo::cuda
