// The springs of a body on the chip: their forces, records and energy.
//
// Each lane of a warp takes a mass and computes the springs that the mass owns, one spring per row. It sums their
// forces in registers, and adds the opposite force to the mass at the other end by atomic additions of integers in
// shared memory. So each spring is computed once, and no sum depends on the order of its terms.
//
// In a cluster, the springs between two parts of a body are cut: both parts compute them, each for its own mass. As
// forces are integers, both get exactly opposite ones.
#pragma once

#include EVODEVO_MATERIALS

namespace evodevo::cuda {

using Fixed = FixedPoint<Number>;
using Integer = Fixed::Integer;
constexpr unsigned plane = plane_bytes<Number>;
constexpr unsigned group_size = group_bytes<Number, dashpots>;

__device__ __forceinline__ Vector position_at(unsigned offset) {
  return {on_chip<Number>(offset), on_chip<Number>(offset + plane), on_chip<Number>(offset + 2 * plane)};
}

/// The velocity at which dashpots act on a mass.
template <class T = Number>
__device__ __forceinline__ Vector velocity_at(unsigned offset) {
  static_assert(only_for<dashpots, T>);
  return {on_chip<Number>(offset + 6 * plane), on_chip<Number>(offset + 7 * plane),
          on_chip<Number>(offset + 8 * plane)};
}

__device__ __forceinline__ unsigned offset_of_mass(unsigned index) {
  return index / lanes * group_size + index % lanes * static_cast<unsigned>(sizeof(Number));
}

__device__ __forceinline__ Integer bits(float value) { return __float_as_uint(value); }
__device__ __forceinline__ Integer bits(double value) { return static_cast<Integer>(__double_as_longlong(value)); }

/// A spring and the position of the mass at its other end. They are read ahead of their use. The other mass of a cut
/// spring is in the halo, whose present set is at offset `halo_set`.
template <bool cut>
struct Spring {
  Number rest_length;
  bool counted;    // whether sums over springs count it in this part
  unsigned other;  // offset of the mass at the other end
  SpringMaterial material;
  Vector position;
  Vector velocity;  // if there are dashpots
  Number dashpot;   // its coefficient, likewise

  __device__ __forceinline__ Spring(const Records::Read& record, const Lengths& lengths, unsigned halo_set)
      : rest_length(cut ? fabs(record.rest_length) : record.rest_length),
        counted(!cut || !signbit(record.rest_length)),
        other(((static_cast<unsigned>(record.packed) & 0xffffu) << offset_shift) + (cut ? halo_set : 0)),
        material(lengths(record)),
        position(position_at(other)) {
    if constexpr (dashpots) {
      velocity = cut ? position_at(other + 3 * plane) : velocity_at(other);
      dashpot = lengths.damping_of(material);
    }
  }
};

/// The mass whose springs a thread is computing, and the sum of their forces so far.
struct Owner {
  unsigned offset;
  Vector position;
  Vector velocity;  // if there are dashpots
  Integer fx, fy, fz;

  __device__ __forceinline__ explicit Owner(unsigned offset_)
      : offset(offset_), position(position_at(offset_)), fx(0), fy(0), fz(0) {
    if constexpr (dashpots) velocity = velocity_at(offset_);
  }

  __device__ __forceinline__ void flush() const {
    atomicAdd(&on_chip<Integer>(offset + 3 * plane), fx);
    atomicAdd(&on_chip<Integer>(offset + 4 * plane), fy);
    atomicAdd(&on_chip<Integer>(offset + 5 * plane), fz);
  }
};

/// Sums of a thread over its springs and some steps.
struct Sums {
  Number largest = 0;                     // |force|, units
  Number row_stress[unrolled_rows] = {};  // sum of |force| of the spring in each row, if there is one chunk, units
  Number power = 0;                       // sum over the springs, units m/s
};

/// Sums of a thread between two checks.
struct Totals {
  double power = 0;    // units m/s
  Number largest = 0;  // |force|, units
};

/// Springs inside the part of a body that a block simulates, and springs between parts.
enum class Kind { none, inside, cut };

/// The springs of a thread.
struct Share {
  Records records;  // of all slots of the body
  unsigned owner;   // offset of the mass that owns the first row
  unsigned first_slot;
  Kind kind;                        // that of all springs of the warp
  unsigned chunks;                  // 0 if the warp has no springs
  unsigned rows;                    // in each chunk
  const std::uint32_t* group_ends;  // for the warp's chunks: bit r is set if a group or the warp's work ends with row r

  __device__ __forceinline__ unsigned slot(unsigned chunk) const { return first_slot + chunk * rows * lanes; }
};

__device__ __forceinline__ Share share_of(const Body& body) {
  Share share{Records::of(body)};
  const unsigned warp = threadIdx.x / lanes, chunks = chunked ? body.chunks : 1;
  share.kind = warp < body.warps ? Kind::inside : Kind::none;
  if constexpr (clustered)
    if (warp >= body.warps && warp < body.warps + body.cut_warps) share.kind = Kind::cut;
  share.chunks = share.kind == Kind::none ? 0 : chunks;
  share.rows = chunked ? unrolled_rows : body.rows;
  unsigned rows_before = warp * chunks * share.rows;
  if constexpr (clustered)
    if (share.kind == Kind::cut) {
      if constexpr (!chunked) share.rows = body.cut_rows;
      rows_before = chunks * (body.warps * body.rows + (warp - body.warps) * body.cut_rows);
    }
  share.first_slot = rows_before * lanes + threadIdx.x % lanes;
  share.group_ends = body.group_ends + warp * chunks;
  share.owner = offset_of_mass(body.first_group[warp] * lanes + threadIdx.x % lanes);
  return share;
}

/// A pass over the springs.
struct SpringPass {
  Lengths lengths;
  bool recorded = true;   // whether its forces are recorded
  unsigned halo_set = 0;  // offset of the set of the halo that it reads
};

/// Adds the force of the spring at `slot` to the sums of its masses in this part. Returns the absolute force, units.
template <bool cut>
__device__ __forceinline__ Number add_force(const Body& body, unsigned slot, const Spring<cut>& spring, Owner& owner,
                                            const SpringPass& pass, Sums& sums) {
  const auto s = physics::separation(owner.position, spring.position);
  const Number inverse = physics::inverse_length(s);
  const Entry<Number>& entry = spring.material.entry;
  Number factor = physics::spring_factor_by_inverse(inverse, entry.stiffness, entry.rest_force * spring.rest_length);
  const Number pull = factor * physics::length_by_inverse(s, inverse);  // of the spring alone
  Number tension = pull;
  if constexpr (dashpots) {
    const Vector velocity = difference(spring.velocity, owner.velocity);
    factor += physics::dashpot_factor_by_inverse(s, inverse, spring.dashpot, velocity);
    tension = factor * physics::length_by_inverse(s, inverse);
  }
  sums.largest = fmax(sums.largest, fabs(tension));
  if constexpr (work) {
    const Number rate = pass.lengths.rate_of(spring.material) * spring.rest_length;
    const Number watts = physics::actuation_power(pull, rate);
    if (pass.recorded && spring.counted) sums.power += watts;
    if constexpr (muscle_work)
      if (pass.recorded) atomicAdd(in_memory(body.powers) + slot, static_cast<double>(watts));
  }
  if constexpr (peak_force)
    if (pass.recorded) atomicMax(in_memory(body.peak) + slot, bits(fabs(tension)));
  if constexpr (mean_tension)
    if (pass.recorded) atomicAdd(in_memory(body.tensions) + slot, static_cast<double>(tension));
  const Integer x = bits(physics::multiply_add(-factor, s.d.x, Fixed::magic));
  const Integer y = bits(physics::multiply_add(-factor, s.d.y, Fixed::magic));
  const Integer z = bits(physics::multiply_add(-factor, s.d.z, Fixed::magic));
  if constexpr (!cut) {
    atomicAdd(&on_chip<Integer>(spring.other + 3 * plane), x);
    atomicAdd(&on_chip<Integer>(spring.other + 4 * plane), y);
    atomicAdd(&on_chip<Integer>(spring.other + 5 * plane), z);
  }
  owner.fx -= x;
  owner.fy -= y;
  owner.fz -= z;
  return fabs(tension);
}

/// Adds the forces of a chunk of rows, beginning at `slot`. The reads of the next row are issued before the atomics of
/// this row, because the compiler must not move them across atomics; so the last row reads ahead, too. The loop ends
/// where the warp's work ends, which is always the end of a group, so that most rows need no test for it.
template <bool cut>
__device__ __forceinline__ void add_forces(const Body& body, const Share& share, unsigned slot, unsigned group_ends,
                                           const SpringPass& pass, Owner& owner, Sums& sums) {
  const Records records = share.records.from(slot);
  Records::Read record = records[lanes];
  Spring<cut> next(records[0], pass.lengths, pass.halo_set);
#pragma unroll
  for (unsigned row = 0; row < unrolled_rows; ++row) {
    const Spring<cut> spring = next;
    if (row + 1 < unrolled_rows) next = Spring<cut>(record, pass.lengths, pass.halo_set);
    if (row + 2 < unrolled_rows) record = records[(row + 2) * lanes];
    const Number force = add_force(body, slot + row * lanes, spring, owner, pass, sums);
    if constexpr (stress) {
      // no thread waits for this addition to memory; the sum has one writer, so its order is fixed
      const Number recorded = pass.recorded ? force : Number(0);
      if constexpr (chunked)
        atomicAdd(in_memory(body.recent_stress) + slot + row * lanes, recorded);
      else
        sums.row_stress[row] += recorded;
    }
    if (group_ends >> row & 1) {
      owner.flush();
      if (!chunked && group_ends >> row == 1) break;  // the warp's work ends
      owner = Owner(owner.offset + group_size);
    }
  }
}

template <bool cut>
__device__ __forceinline__ void add_spring_forces(const Body& body, const Share& share, unsigned group_ends,
                                                  const SpringPass& pass, Sums& sums) {
  Owner owner(share.owner);
  if constexpr (chunked) {
    for (unsigned chunk = 0; chunk < share.chunks; ++chunk)
      add_forces<cut>(body, share, share.slot(chunk), share.group_ends[chunk], pass, owner, sums);
  } else {
    add_forces<cut>(body, share, share.first_slot, group_ends, pass, owner, sums);
  }
}

/// Adds the sums of some steps to the body's records and to the totals.
__device__ __forceinline__ void collect(const Body& body, const Share& share, const Sums& sums, Totals& totals) {
  totals.largest = fmax(totals.largest, sums.largest);
  if constexpr (work) totals.power += sums.power;
  if constexpr (stress) {
    for (unsigned chunk = 0; chunk < (chunked ? share.chunks : 1); ++chunk) {
      double* const to = body.stress + share.slot(chunk);
      Number* const recent = body.recent_stress + share.slot(chunk);
      constexpr unsigned at_once = 8;  // read before the first write, because a read after a write would wait for it
#pragma unroll
      for (unsigned first = 0; first < unrolled_rows; first += at_once) {
        double before[at_once];
#pragma unroll
        for (unsigned i = 0; i < at_once; ++i) before[i] = to[min(first + i, share.rows - 1) * lanes];
#pragma unroll
        for (unsigned i = 0; i < at_once; ++i) {
          const unsigned row = first + i;
          const Number forces = chunked ? __ldcg(recent + row * lanes) : sums.row_stress[row];
          const double sum = before[i] + body.resolution * forces;
          if (row < share.rows) to[row * lanes] = sum;
          if constexpr (chunked) recent[row * lanes] = 0;
        }
      }
    }
  }
}

/// A spring as it is now.
struct Stretched {
  unsigned slot;
  bool counted;  // Spring::counted
  Number rest_length;
  Entry<Number> entry;
  physics::Separation<Number> separation;
};

/// Calls function(Stretched) for each spring of a thread.
template <bool cut, class Function>
__device__ __forceinline__ void for_each_spring(const Share& share, const Lengths& lengths, unsigned halo_set,
                                                const Function& function) {
  unsigned offset = share.owner;
  for (unsigned chunk = 0; chunk < share.chunks; ++chunk) {
    const unsigned group_ends = share.group_ends[chunk];
    for (unsigned row = 0; row < share.rows; ++row) {
      const unsigned slot = share.slot(chunk) + row * lanes;
      const Spring<cut> spring(share.records[slot], lengths, halo_set);
      function(Stretched{slot, spring.counted, spring.rest_length, spring.material.entry,
                         physics::separation(position_at(offset), spring.position)});
      if (group_ends >> row & 1) offset += group_size;
    }
  }
}

template <class Function>
__device__ __forceinline__ void for_each_spring(const Share& share, const Lengths& lengths, unsigned halo_set,
                                                const Function& function) {
  if (clustered && share.kind == Kind::cut)
    for_each_spring<clustered>(share, lengths, halo_set, function);
  else
    for_each_spring<false>(share, lengths, halo_set, function);
}

/// The elastic energy of a thread's springs, units m. The first row of lengths must be the current one.
__device__ double elastic_energy(const Body& body, const Share& share, unsigned halo_set) {
  double sum = 0;
  for_each_spring(share, Lengths(body), halo_set, [&](const Stretched& spring) {
    if (!spring.counted) return;
    // an empty slot has no stiffness
    const Number relative = spring.entry.rest_force / physics::maximum(spring.entry.stiffness, Number(1e-30));
    sum += physics::elastic_energy(spring.separation, spring.entry.stiffness, spring.rest_length * relative);
  });
  return sum;
}

/// Writes the force of each spring into a sample (N), without that of its dashpot, in the order of the slots.
__device__ __forceinline__ void write_forces(const Body& body, const Share& share, const Lengths& lengths,
                                             unsigned halo_set, float* to) {
  for_each_spring(share, lengths, halo_set, [&](const Stretched& spring) {
    const Number inverse = physics::inverse_length(spring.separation);
    const Number factor = physics::spring_factor_by_inverse(inverse, spring.entry.stiffness,
                                                            spring.entry.rest_force * spring.rest_length);
    to[spring.slot] =
        static_cast<float>(factor * physics::length_by_inverse(spring.separation, inverse) * body.resolution);
  });
}

}  // namespace evodevo::cuda
