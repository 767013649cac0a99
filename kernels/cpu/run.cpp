#include "cpu/run.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/computed_materials.hpp"
#include "analysis/guard.hpp"
#include "analysis/sampling.hpp"
#include "analysis/split_materials.hpp"
#include "cpu/coloured_springs.hpp"

namespace evodevo::cpu {
namespace {

template <class T>
TimeSpan<T> time_span(const Scene& scene, double dt) {
  const double rate = scene.damping ? scene.damping->rate : 0;
  const double damped_dt = rate > 0 ? -std::expm1(-rate * dt) / rate : dt;
  return {static_cast<T>(dt), static_cast<T>(std::exp(-rate * dt)), static_cast<T>(damped_dt)};
}

template <class T>
StepConstants<T> step_constants(const Scene& scene, double dt) {
  const auto as_t = [](double value) { return static_cast<T>(value); };
  return {.gravity = scene.gravity.has_value(),
          .slope = scene.on_slope(),
          .floor = scene.floor.has_value(),
          .rigid = scene.floor && scene.floor->rigid(),
          .rough = scene.floor && scene.floor->rough(),
          .friction = scene.friction && scene.floor,
          .static_friction = scene.friction && scene.friction->higher_at_rest(),
          .drag = scene.drag.has_value(),
          .damping = scene.damping.has_value(),
          .acceleration = as_t(scene.gravity ? scene.gravity->downwards() : 0),
          .grade = as_t(scene.gravity ? scene.gravity->grade() : 0),
          .floor_stiffness = as_t(scene.floor ? scene.floor->stiffness : 0),
          .restitution = as_t(scene.floor ? scene.floor->restitution.value_or(0) : 0),
          .roughness = as_t(scene.floor ? scene.floor->roughness : 0),
          .cells = as_t(scene.floor ? 2 / scene.floor->wavelength : 0),
          .seed = scene.floor ? scene.floor->first_line() : 0,
          .friction_coefficient = as_t(scene.friction ? scene.friction->coefficient : 0),
          .static_coefficient = as_t(scene.friction ? scene.friction->holding() : 0),
          .drag_coefficient = as_t(scene.drag ? scene.drag->coefficient : 0),
          .damping_rate = as_t(scene.damping ? scene.damping->rate : 0),
          .step = time_span<T>(scene, dt),
          .half_step = time_span<T>(scene, dt / 2)};
}

/// Owns the memory of Actuation.
template <class T>
class ActuationTables {
 public:
  ActuationTables(const Body& body, std::size_t rows, std::size_t multiple, Sums sums)
      : materials_(body.materials.size()),
        padded_(std::max<std::size_t>(1, (materials_ + multiple - 1) / multiple) * multiple),
        amplitude_(padded_),
        frequency_(padded_),
        phase_(padded_),
        length_(rows * padded_),
        rate_(sums.power ? rows * padded_ : 0) {
    for (std::size_t i = 0; i < materials_; ++i) {
      amplitude_[i] = body.materials[i].amplitude;
      frequency_[i] = body.materials[i].frequency;
      phase_[i] = std::remainder(body.materials[i].phase, 2 * 3.14159265358979323846);
    }
  }

  /// Returns the tables, beginning with row `first`.
  Actuation<T> view(std::size_t first = 0) {
    return {.materials = materials_,
            .padded = padded_,
            .amplitude = amplitude_.data(),
            .frequency = frequency_.data(),
            .phase = phase_.data(),
            .relative_length = length_.data() + first * padded_,
            .relative_rate = rate_.size() > 0 ? rate_.data() + first * padded_ : nullptr};
  }

 private:
  std::size_t materials_, padded_;
  Array<double> amplitude_, frequency_, phase_;
  Array<T> length_, rate_;
};

/// Owns the memory of Motion.
template <class T>
class MovingBody {
 public:
  MovingBody(const Body& body, const State& state, std::size_t lanes, const Integrator<T>& integrator, Sums sums,
             bool counts_contacts)
      : layout_(body, lanes),
        mass_(layout_.padded_masses()),
        inverse_mass_(layout_.padded_masses()),
        interleaved_positions_(position_stride * layout_.padded_masses()),
        interleaved_velocities_(layout_.damping.size() > 0 ? position_stride * layout_.padded_masses() : 0),
        mass_scratch_(integrator.mass_arrays * layout_.padded_masses()),
        slot_scratch_(integrator.slot_arrays * layout_.slots()),
        force_sum_(sums.force ? layout_.slots() : 0),
        power_sum_(sums.power ? layout_.slots() : 0),
        peak_(sums.peak ? layout_.slots() : 0),
        tension_sum_(sums.tension ? layout_.slots() : 0),
        contact_steps_(counts_contacts ? layout_.padded_masses() : 0),
        contacts_(counts_contacts ? layout_.masses : 0) {
    if (integrator.coloured) coloured_ = ColouredSprings<T>(body, layout_);
    for (auto* arrays : {&position_, &velocity_, &force_})
      for (Array<T>& array : *arrays) array = Array<T>(layout_.padded_masses());
    for (Array<T>* array : {&floor_force_, &arrival_, &push_}) *array = Array<T>(layout_.padded_masses());
    for (std::size_t i = 0; i < layout_.masses; ++i) {
      const std::uint32_t from = layout_.mass_at[i];
      const double mass = body.masses[from].mass;
      mass_[i] = static_cast<T>(mass);
      // an inverse mass of 0 holds a mass of 0 kg in place
      inverse_mass_[i] = static_cast<T>(mass > 0 ? 1 / mass : 0);
      put(position_, i, state.position[from]);
      put(velocity_, i, state.velocity[from]);
      for (std::size_t c = 0; c < 3; ++c) interleaved_positions_[position_stride * i + c] = position_[c][i];
    }
  }

  Motion<T> view() {
    return {.groups = layout_.groups,
            .first_row = layout_.first_row.data(),
            .neighbour = layout_.neighbour.data(),
            .stiffness = layout_.stiffness.data(),
            .rest_length = layout_.rest_length.data(),
            .damping = data_of(layout_.damping),
            .material = layout_.material.data(),
            .coloured = {.size = coloured_.size,
                         .a = coloured_.a.data(),
                         .b = coloured_.b.data(),
                         .slot = coloured_.slot.data(),
                         .stiffness = coloured_.stiffness.data(),
                         .rest_length = coloured_.rest_length.data(),
                         .inverse_mass_a = coloured_.inverse_mass_a.data(),
                         .inverse_mass_b = coloured_.inverse_mass_b.data(),
                         .damping = data_of(coloured_.damping),
                         .material = coloured_.material.data()},
            .mass = mass_.data(),
            .inverse_mass = inverse_mass_.data(),
            .x = position_[0].data(),
            .y = position_[1].data(),
            .z = position_[2].data(),
            .interleaved_positions = interleaved_positions_.data(),
            .vx = velocity_[0].data(),
            .vy = velocity_[1].data(),
            .vz = velocity_[2].data(),
            .interleaved_velocities = data_of(interleaved_velocities_),
            .fx = force_[0].data(),
            .fy = force_[1].data(),
            .fz = force_[2].data(),
            .floor_force = floor_force_.data(),
            .arrival = arrival_.data(),
            .push = push_.data(),
            .mass_scratch = mass_scratch_.data(),
            .slot_scratch = slot_scratch_.data(),
            .slots = layout_.slots(),
            .force_sum = data_of(force_sum_),
            .power_sum = data_of(power_sum_),
            .peak = data_of(peak_),
            .tension_sum = data_of(tension_sum_),
            .contact_steps = data_of(contact_steps_)};
  }

  /// Adds the sums of the slots to the task's records and sets them to zero. The sums between two checks have few
  /// enough terms for float32.
  void collect(Task& task) {
    for (std::size_t i = 0; i < layout_.springs; ++i) {
      const std::uint32_t slot = layout_.slot_of[i];
      if (force_sum_.size() > 0) task.stress[i] += force_sum_[slot];
      if (power_sum_.size() > 0) task.work += task.dt * power_sum_[slot];
      if (!task.muscle_work.empty()) task.muscle_work[i] += task.dt * power_sum_[slot];
      if (peak_.size() > 0) task.peak_force[i] = peak_[slot];
      if (tension_sum_.size() > 0) task.tension[i] += tension_sum_[slot];
    }
    force_sum_.clear();
    power_sum_.clear();
    tension_sum_.clear();
    for (std::size_t i = 0; i < contacts_.size(); ++i)
      contacts_[layout_.mass_at[i]] += static_cast<std::uint32_t>(contact_steps_[i]);
    contact_steps_.clear();
  }

  /// The number of steps after which each mass touched the ground, by its index in the body; empty if not counted.
  std::vector<std::uint32_t> contacts() const {
    std::vector<std::uint32_t> steps = contacts_;
    for (std::size_t i = 0; i < steps.size(); ++i)
      steps[layout_.mass_at[i]] += static_cast<std::uint32_t>(contact_steps_[i]);
    return steps;
  }

  /// The sum of the power of all muscles since the last call of collect(), W.
  double uncollected_power() const {
    double sum = 0;
    for (std::size_t i = 0; i < layout_.springs; ++i) sum += power_sum_[layout_.slot_of[i]];
    return sum;
  }

  /// Lets dashpots act at these velocities [masses], m/s, in the next step. Does nothing if there are none.
  void set_dashpot_velocities(std::span<const Vec3> velocities) {
    if (interleaved_velocities_.size() == 0) return;
    for (std::size_t i = 0; i < layout_.masses; ++i) {
      const Vec3 v = velocities[layout_.mass_at[i]];
      T* to = interleaved_velocities_.data() + position_stride * i;
      to[0] = static_cast<T>(v.x), to[1] = static_cast<T>(v.y), to[2] = static_cast<T>(v.z);
    }
  }

  /// The velocities at which dashpots act in the next step [masses], m/s; empty if there are no dashpots.
  std::vector<Vec3> dashpot_velocities() const {
    std::vector<Vec3> velocities(interleaved_velocities_.size() > 0 ? layout_.masses : 0);
    for (std::size_t i = 0; i < velocities.size(); ++i) {
      const T* from = interleaved_velocities_.data() + position_stride * i;
      velocities[layout_.mass_at[i]] = {from[0], from[1], from[2]};
    }
    return velocities;
  }

  void write(State& state) const {
    for (std::size_t i = 0; i < layout_.masses; ++i) {
      state.position[layout_.mass_at[i]] = {position_[0][i], position_[1][i], position_[2][i]};
      state.velocity[layout_.mass_at[i]] = {velocity_[0][i], velocity_[1][i], velocity_[2][i]};
    }
  }

 private:
  static T* data_of(Array<T>& array) { return array.size() > 0 ? array.data() : nullptr; }

  static void put(Array<T> (&to)[3], std::size_t i, Vec3 v) {
    to[0][i] = static_cast<T>(v.x);
    to[1][i] = static_cast<T>(v.y);
    to[2][i] = static_cast<T>(v.z);
  }

  Layout<T> layout_;
  ColouredSprings<T> coloured_;
  Array<T> mass_, inverse_mass_, interleaved_positions_, interleaved_velocities_, mass_scratch_, slot_scratch_,
      floor_force_, arrival_, push_;
  Array<T> force_sum_, power_sum_, peak_, tension_sum_, contact_steps_;
  std::vector<std::uint32_t> contacts_;  ///< contact steps as far as they have been collected
  Array<T> position_[3], velocity_[3], force_[3];
};

/// Takes the samples of a task.
template <class T>
class Sampler {
 public:
  /// `body` is the task's body with the materials that are simulated.
  Sampler(const Body& body, Task& task) : body_(body), task_(task), state_{task.state->position, task.state->velocity} {
    for (const SamplePoint& point : task.sampled_at) requested_ = requested_ | point.channels;
  }

  bool counts_contacts() const { return requested_.contact || requested_.contacts; }
  bool needs_power() const { return requested_.work; }

  /// Returns the number of steps from step `step` to the next sample, but at most `most`.
  std::uint64_t steps_before_next(std::uint64_t step, std::uint64_t most) const {
    const std::size_t next = task_.samples.size();
    return next < task_.sampled_at.size() ? std::min(most, task_.sampled_at[next].step - step) : most;
  }

  /// Takes the samples after step `step`, at `time` (s since birth). Before the first step, the state is not rounded.
  void take(std::uint64_t step, double time, const MovingBody<T>& moving) {
    for (std::size_t next = task_.samples.size(); next < task_.sampled_at.size() && task_.sampled_at[next].step == step;
         ++next) {
      if (step > 0) moving.write(state_);
      const Channels& channels = task_.sampled_at[next].channels;
      Sample& sample = task_.samples.emplace_back(sample_of(body_, state_, time, channels));
      if (channels.work) sample.work = task_.work + task_.dt * moving.uncollected_power();
      if (!channels.contact && !channels.contacts) continue;
      std::vector<std::uint32_t> contacts = moving.contacts();
      if (channels.contact) sample.contact_steps = std::accumulate(contacts.begin(), contacts.end(), std::uint64_t{0});
      if (channels.contacts) sample.contacts = std::move(contacts);
    }
  }

 private:
  const Body& body_;
  Task& task_;
  State state_;
  Channels requested_;  ///< by any sample
};

/// Checks a body, and ends its run if it has diverged.
void check(Task& task, Course& course, const Scene& scene, const Energies& e) {
  if (e.finite) course.fallen = std::max(course.fallen, fallen_energy(scene, e.height_moment));
  task.reason = divergence_reason(course, task.dt, e.kinetic, e.elastic, e.finite);
  if (task.reason.empty()) return;
  task.status = Status::diverged;
  task.ended_at = course.time(task.dt);
  task.clear({}, 0);
  task.samples.clear();
}

}  // namespace

template <class T>
void run(Task& task, const Scene& scene, const Stepping& stepping, const Kernels<T>& kernels, Recording recording) {
  Body coded;  // the body with rounded materials, if materials are computed
  if (stepping.materials == Materials::computed) {
    task.split = SplitBody::of(*task.body, std::move(task.split));
    coded = task.split ? task.split->body() : *task.body;
    coded.materials = simulated_materials(coded, stepping.materials);
  }
  const Body& body = stepping.materials == Materials::computed ? coded : *task.body;
  State& state = *task.state;
  task.samples.clear();
  Sampler<T> sampler(body, task);
  const Sums sums{.force = recording.stress,
                  .power = recording.work || recording.muscle_work || sampler.needs_power(),
                  .peak = recording.peak_force,
                  .tension = recording.tension};
  const StepConstants<T> constants = step_constants<T>(scene, task.dt);
  Course course = course_of(task, scene, stepping.precision);
  const Integrator<T>& integrator = kernels.integrator[static_cast<std::size_t>(stepping.method)];
  const std::size_t rows = integrator.rows_per_step;
  MovingBody<T> moving(body, state, kernels.lanes, integrator, sums, sampler.counts_contacts());
  moving.set_dashpot_velocities(course.dashpot_velocity.empty() ? state.velocity : course.dashpot_velocity);
  ActuationTables<T> tables(body, guard_interval * rows + 1, kernels.table_size, sums);
  task.clear(recording, body.springs.size());
  task.work = 0;
  task.spring_evaluations = 0;

  const std::uint64_t begin = course.steps, end = begin + task.steps;
  sampler.take(0, course.time(task.dt), moving);
  while (course.steps < end && task.status == Status::ok) {
    const std::size_t now = std::min(end - course.steps, guard_interval - course.steps % guard_interval);
    kernels.actuate(tables.view(), course.origin, course.steps * rows, now * rows + 1,
                    task.dt / static_cast<double>(rows));
    for (std::size_t row = 0, left = now; left > 0;) {
      const std::size_t steps = sampler.steps_before_next(course.steps - begin, left);
      integrator.advance(moving.view(), constants, tables.view(row), steps, sums);
      row += steps * rows;
      left -= steps;
      course.steps += steps;
      sampler.take(course.steps - begin, course.time(task.dt), moving);
    }
    moving.collect(task);
    task.spring_evaluations += now * body.springs.size();
    if (is_checked(task, course))
      check(task, course, scene, kernels.energies(moving.view(), constants, tables.view(now * rows)));
  }
  if (stepping.method == Method::velocity_verlet) course.dashpot_velocity = moving.dashpot_velocities();
  apply_course(task, course);
  if (task.steps > 0) moving.write(state);  // without steps the state is not even rounded to T
  if (!recording.work || task.status != Status::ok) task.work = 0;
  for (auto* means : {&task.stress, &task.tension})
    for (double& mean : *means) mean /= static_cast<double>(std::max<std::uint64_t>(task.steps, 1));
}

template void run(Task&, const Scene&, const Stepping&, const Kernels<float>&, Recording);
template void run(Task&, const Scene&, const Stepping&, const Kernels<double>&, Recording);

}  // namespace evodevo::cpu
