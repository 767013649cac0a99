// Simulates a body in one thread block, or in a cluster of thread blocks, each of which simulates a part of it. The
// body's state is on the chip from the first step to the last.
//
//   load                body in the device's memory ─► shared memory, registers
//   repeat until the end or a divergence:
//     fill_lengths      times ─► lengths of the materials in the next steps
//     advance, for each pass over the springs:
//       add_spring_forces   positions, lengths ─► force sums (integers) in shared memory; records of the springs
//       move_masses         force sums ─► velocities, positions
//       Halo::send          positions ─► the blocks of other parts, which get them while they compute springs inside
//     collect           sums of these steps ─► records in the device's memory
//     has_diverged      energies ─► answer, whether to stop
//   store               registers, shared memory ─► body in the device's memory
//
// The host compiles this file at run time for each combination of features that a scene and a body ask for; a feature
// that is off leaves no instruction.
#include EVODEVO_METHOD
#include "cuda/device/cluster.cuh"
#include "cuda/device/sampling.cuh"

namespace evodevo::cuda {

/// The velocities of the masses that a thread moves: those of index threadIdx.x, threadIdx.x + blockDim.x, ..
struct Movers {
  Vector velocity[masses_per_thread];
  Method::Kept kept[masses_per_thread];
  std::uint32_t contact_steps[masses_per_thread] = {};
};

template <class Function>
__device__ __forceinline__ void for_each_mover(const Body& body, const Function& function) {
#pragma unroll
  for (unsigned i = 0; i < masses_per_thread; ++i) {
    const unsigned index = threadIdx.x + i * blockDim.x;
    if (index < body.groups * lanes) function(i, index, offset_of_mass(index));
  }
}

__device__ __forceinline__ void set_force(unsigned offset, Integer value) {
  on_chip<Integer>(offset + 3 * plane) = value;
  on_chip<Integer>(offset + 4 * plane) = value;
  on_chip<Integer>(offset + 5 * plane) = value;
}

__device__ __forceinline__ void set_position(unsigned offset, Vector position) {
  on_chip<Number>(offset) = position.x;
  on_chip<Number>(offset + plane) = position.y;
  on_chip<Number>(offset + 2 * plane) = position.z;
}

template <class T = Number>
__device__ __forceinline__ void set_dashpot_velocity(unsigned offset, Vector velocity) {
  static_assert(only_for<dashpots, T>);
  on_chip<Number>(offset + 6 * plane) = velocity.x;
  on_chip<Number>(offset + 7 * plane) = velocity.y;
  on_chip<Number>(offset + 8 * plane) = velocity.z;
}

/// Returns the sum of the spring forces on a mass, N, and sets the sum to its start value for the next pass.
__device__ __forceinline__ Vector take_force(unsigned offset, Integer start, Number resolution) {
  const auto newtons = [&](unsigned at) {
    return static_cast<Number>(static_cast<Fixed::Signed>(on_chip<Integer>(at))) * resolution;
  };
  const Vector force{newtons(offset + 3 * plane), newtons(offset + 4 * plane), newtons(offset + 5 * plane)};
  set_force(offset, start);
  return force;
}

__device__ __forceinline__ void move_masses(const Body& body, const StepConstants<Number>& constants, Number resolution,
                                            Pass pass, Movers& movers) {
  for_each_mover(body, [&](unsigned i, unsigned index, unsigned offset) {
    const Vector force = take_force(offset, __ldg(body.start + index), resolution);
    Moving m{position_at(offset), movers.velocity[i], force, __ldg(body.mass + index),
             __ldg(body.inverse_mass + index)};
    Method::move(constants, pass, movers.kept[i], m);
    set_position(offset, m.position);
    if constexpr (dashpots)
      set_dashpot_velocity(offset, Method::dashpot_velocity(constants, pass, m, velocity_at(offset)));
    movers.velocity[i] = m.velocity;
    if constexpr (contacts && has_floor)
      if (Method::ends_motion(pass)) movers.contact_steps[i] += touches(constants, m);
  });
}

/// Copies the body onto the chip.
__device__ __forceinline__ void load(const Body& body, Movers& movers) {
  const Motion<Number>& m = body.motion;
  for_each_mover(body, [&](unsigned i, unsigned index, unsigned offset) {
    set_position(offset, {m.x[index], m.y[index], m.z[index]});
    movers.velocity[i] = {m.vx[index], m.vy[index], m.vz[index]};
    if constexpr (dashpots)
      set_dashpot_velocity(
          offset, {body.dashpot_velocity.x[index], body.dashpot_velocity.y[index], body.dashpot_velocity.z[index]});
    set_force(offset, body.start[index]);
    if constexpr (contacts) movers.contact_steps[i] = body.sampling.contact_steps[index];
  });
  // the masses to which empty slots refer
  if (threadIdx.x < lanes) {
    const unsigned offset = offset_of_mass(body.groups * lanes + threadIdx.x);
    set_position(offset, {0, 0, 0});
    if constexpr (dashpots) set_dashpot_velocity(offset, {0, 0, 0});
    set_force(offset, 0);
  }
  const unsigned rows_of_chunks = body.warps * body.rows + (clustered ? body.cut_warps * body.cut_rows : 0);
  const unsigned rows = rows_of_chunks * (chunked ? body.chunks : 1);
  Records::load(body, lanes * (rows + rows_read_ahead));
}

__device__ __forceinline__ void store(const Body& body, const Movers& movers) {
  const Motion<Number>& m = body.motion;
  for_each_mover(body, [&](unsigned i, unsigned index, unsigned offset) {
    const Vector at = position_at(offset);
    m.x[index] = at.x;
    m.y[index] = at.y;
    m.z[index] = at.z;
    m.vx[index] = movers.velocity[i].x;
    m.vy[index] = movers.velocity[i].y;
    m.vz[index] = movers.velocity[i].z;
    if constexpr (contacts) body.sampling.contact_steps[index] = movers.contact_steps[i];
    if constexpr (dashpots) {
      const Vector velocity = velocity_at(offset);
      body.dashpot_velocity.x[index] = velocity.x;
      body.dashpot_velocity.y[index] = velocity.y;
      body.dashpot_velocity.z[index] = velocity.z;
    }
  });
}

/// A thread's contribution to the numbers that a check needs. It is passed by value: variables that are passed by
/// reference to a function that is not inlined would be kept in memory instead of registers everywhere.
struct Check {
  double kinetic = 0;        // J
  double height_moment = 0;  // kg m
  Number not_finite = 0;     // 0 if all positions and velocities are finite
  Totals totals;
};

__device__ __forceinline__ Check check_of(const Body& body, const Movers& movers, const Totals& totals) {
  Check check;
  check.totals = totals;
  for_each_mover(body, [&](unsigned i, unsigned index, unsigned offset) {
    const Vector position = position_at(offset), v = movers.velocity[i];
    const Number mass = body.mass[index];
    check.kinetic += physics::kinetic_energy(mass, v);
    if constexpr (gravity) check.height_moment += height_moment_of(mass, position, body.constants);
    check.not_finite += not_finite(position, v);
  });
  return check;
}

/// Writes the body's energies after `steps` steps of its piece into its answer. Returns to all threads whether the body
/// has diverged; that is decided only if a check is due. The blocks of a cluster all decide the same.
__device__ __noinline__ bool has_diverged(const Body& body, Check check, std::uint64_t steps, Halo halo) {
  const Share share = share_of(body);
  if (clustered && share.kind == Kind::cut) halo.wait();
  bool finite = !__syncthreads_or(check.not_finite != 0);
  bool out_of_range = __syncthreads_or(!(check.totals.largest <= body.largest_force)) || body.piece.left_range != 0;
  double kinetic = block_sum(check.kinetic, of_warps[0]);
  double elastic = body.resolution * block_sum(elastic_energy(body, share, halo.set()), of_warps[1]);
  double height_moment = 0;
  double power = 0;
  if constexpr (gravity) height_moment = block_sum(check.height_moment, of_warps[2]);
  if constexpr (work) power = block_sum(check.totals.power, of_warps[3]);
  if constexpr (clustered) {
    double* const mine = cluster::of_block;
    if (threadIdx.x == 0) {
      mine[0] = finite ? 0 : 1;
      mine[1] = out_of_range ? 1 : 0;
      mine[2] = kinetic;
      mine[3] = elastic;
      if constexpr (gravity) mine[4] = height_moment;
      if constexpr (work) mine[5] = power;
    }
    cluster::join_blocks(6, Add());
    const double* const all = cluster::of_cluster;
    finite = all[0] == 0;
    out_of_range = all[1] > 0;
    kinetic = all[2];
    elastic = all[3];
    if constexpr (gravity) height_moment = all[4];
    if constexpr (work) power = all[5];
  }
  const bool checked = is_checked(body.piece, steps);
  Answer& answer = *body.answer;
  if constexpr (gravity)
    if (threadIdx.x == 0 && checked && finite) record_fall(height_moment, body.constants, answer);
  if constexpr (work)
    if (threadIdx.x == 0) answer.work += body.constants.exact_dt * body.resolution * power;
  bool diverged = false;
  if (threadIdx.x == 0) {
    answer.steps = steps;
    answer.kinetic = kinetic;
    answer.elastic = elastic;
    answer.finite = finite;
    answer.out_of_range = out_of_range;
    diverged = checked && (!finite || out_of_range || has_gained(body.piece, body.constants, answer));
    answer.diverged = diverged;
  }
  return __syncthreads_or(diverged);
}

/// Writes the sums and extremes of a whole body into the sample. Nothing else may use of_warps until the block is
/// synchronised again.
__device__ __forceinline__ void write_reduced(const SampleMark& mark, Reduction& reduction) {
  if constexpr (!clustered) {
    reduction.write(mark);
  } else {
    auto* to = reinterpret_cast<ReducedSample*>(mark.to);
    const bool writes = cluster::rank() == 0 && threadIdx.x < 8;
    if (Reduction::has_sums(mark)) {
      reduction.write_sums(cluster::of_block);
      cluster::join_blocks(8, Add());
      if (writes) to->centre[threadIdx.x] = cluster::of_cluster[threadIdx.x];
    }
    if (Reduction::has_extremes(mark)) {
      reduction.write_extremes(cluster::of_block);
      cluster::join_blocks(8, Larger());
      if (writes) to->low[threadIdx.x] = cluster::of_cluster[threadIdx.x];
    }
  }
}

/// Takes the samples that are due after `done` steps. `lengths` are the present ones; `totals` are those of all steps
/// since the last check. Nothing else may use of_warps until the block is synchronised again.
__device__ __forceinline__ void take_samples(const Body& body, const Share& share, const Lengths& lengths,
                                             const Halo& halo, const Movers& movers, const Totals& totals,
                                             std::uint64_t done, NextSample& next) {
  const Sampling& sampling = body.sampling;
  if (clustered && share.kind == Kind::cut) halo.wait();
  while (true) {
    const SampleMark mark = next.take(sampling);
    const SampleLists lists(mark, sampling.masses);
    Reduction reduction;
    for_each_mover(body, [&](unsigned i, unsigned index, unsigned offset) {
      if (sampling.mass_share[index] < 0) return;  // padding
      const unsigned of_body = index + (clustered ? sampling.first_mass : 0);
      sample_mass(sampling, mark, lists, index, of_body, position_at(offset), movers.velocity[i], reduction);
      if constexpr (contacts) sample_contact(mark, lists, of_body, movers.contact_steps[i], reduction);
    });
    if constexpr (work) {
      reduction.add_work(body.constants.exact_dt * body.resolution * totals.power);
      if (threadIdx.x == 0 && (!clustered || cluster::rank() == 0)) reduction.add_work(body.answer->work);
    }
    write_reduced(mark, reduction);
    if (mark.channels & forces_bit)
      write_forces(body, share, lengths, halo.set(), lists.forces + (clustered ? sampling.first_slot : 0));
    if (next.step != done) return;
    synchronise_warps();
  }
}

/// Computes `count` steps after the first `done`; the table holds their lengths. The sums exist only in this function,
/// which calls only inlined functions, so they stay in registers. A warp without springs only moves masses. Takes the
/// samples that are due before the last of these steps; after each, passes are numbered anew.
/// In a cluster, warps with cut springs wait in each pass for positions from other blocks, while the others compute.
template <Kind kind>
__device__ __forceinline__ void advance(const Body& body, const StepConstants<Number>& constants, const Share& share,
                                        unsigned group_ends, unsigned count, Movers& movers, Halo& halo, Totals& totals,
                                        [[maybe_unused]] std::uint64_t done, [[maybe_unused]] NextSample& next) {
  const Number resolution = static_cast<Number>(body.resolution);
  SpringPass springs{Lengths(body)};
  [[maybe_unused]] Sums sums;
  unsigned passes = opening_passes + count * passes_per_step;
  [[maybe_unused]] unsigned left = 0;  // steps after the next sample
  if constexpr (sampled) {
    const unsigned now = next.steps_from(done, count);
    left = count - now;
    passes = opening_passes + now * passes_per_step;
  }
  for (unsigned pass = 0; pass < passes; ++pass) {
    springs.recorded = Method::is_recorded(pass);
    if constexpr (kind == Kind::inside) add_spring_forces<false>(body, share, group_ends, springs, sums);
    if constexpr (kind == Kind::cut) {
      halo.wait();
      springs.halo_set = halo.set();
      add_spring_forces<true>(body, share, group_ends, springs, sums);
    }
    synchronise_warps();
    move_masses(body, constants, resolution, {pass, pass + 1 == passes}, movers);
    synchronise_warps();
    if constexpr (clustered) halo.template send<kind>(body);
    unsigned rows_on = Method::row(pass + 1) - Method::row(pass);
    if constexpr (sampled)
      if (pass + 1 == passes) rows_on -= opening_passes;  // an opening pass reads the row of the last pass again
    if constexpr (actuation) springs.lengths.advance_rows(body, rows_on);
    if constexpr (sampled) {
      if (pass + 1 < passes || left == 0) continue;
      Totals so_far = totals;
      if constexpr (work) so_far.power += sums.power;
      const std::uint64_t at = done + (count - left);
      take_samples(body, share, springs.lengths, halo, movers, so_far, at, next);
      const unsigned now = next.steps_from(at, left);
      left -= now;
      passes = opening_passes + now * passes_per_step;
      pass = 0u - 1;
    }
  }
  if constexpr (kind != Kind::none) collect(body, share, sums, totals);
}

extern "C" __global__ void __launch_bounds__(EVODEVO_MAX_THREADS, 1)
    evodevo_run_resident(const Body* bodies, [[maybe_unused]] std::uint64_t range) {
  const Body& body = bodies[blockIdx.x];
  const Share share = share_of(body);
  const unsigned group_ends = chunked ? 0 : *share.group_ends;
  std::uint64_t begin = 0, steps = body.piece.steps;
  Movers movers;
  Halo halo;
  Totals totals;
  NextSample next;
  if constexpr (sampled) {
    begin = steps_before_span(body.piece, range * body.sampling.spans_per_range);
    steps = steps_before_span(body.piece, (range + 1) * body.sampling.spans_per_range);
    if (begin == steps || body.answer->diverged) return;
    next.seek(body.sampling, begin);
  }
  load(body, movers);
  fill_lengths(body, 0, 1);
  __syncthreads();
  if constexpr (clustered) halo.begin(body, share);
  for (std::uint64_t done = begin; done < steps;) {
    const unsigned since_check = static_cast<unsigned>((body.piece.since_check + done) % guard_interval);
    const unsigned until_check =
        static_cast<unsigned>(min(steps - done, static_cast<std::uint64_t>(guard_interval - since_check)));
    unsigned now = until_check;
    if constexpr (actuation) {
      now = min(until_check, body.table_steps);
      fill_lengths(body, done, now * rows_per_step + end_rows);
      __syncthreads();
    }
    if (share.kind == Kind::inside)
      advance<Kind::inside>(body, body.constants, share, group_ends, now, movers, halo, totals, done, next);
    else if (clustered && share.kind == Kind::cut)
      advance<clustered ? Kind::cut : Kind::none>(body, body.constants, share, group_ends, now, movers, halo, totals,
                                                  done, next);
    else
      advance<Kind::none>(body, body.constants, share, group_ends, now, movers, halo, totals, done, next);
    done += now;
    bool is_due = false;
    if constexpr (sampled) is_due = next.step == done;
    if (now < until_check && !is_due) continue;
    if constexpr (actuation) {
      fill_lengths(body, done, 1);
      __syncthreads();
    }
    if constexpr (sampled) {
      if (is_due) {
        take_samples(body, share, Lengths(body), halo, movers, totals, done, next);
        __syncthreads();
      }
      if (now < until_check) continue;
    }
    if (has_diverged(body, check_of(body, movers, totals), done, halo)) break;
    totals = Totals();
  }
  // a block must not end while others send to it, and they do until it has waited for what they have sent
  if (clustered && share.kind == Kind::cut) halo.wait();
  if constexpr (clustered) cluster::synchronise();
  store(body, movers);
}

}  // namespace evodevo::cuda
