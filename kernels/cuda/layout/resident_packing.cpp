// Writes resident bodies for the device, and reads what it answers.
#include <algorithm>
#include <bit>

#include "cuda/layout/resident.hpp"

namespace evodevo::cuda {

/// The high half of Record::packed for each material.
template <class T>
std::vector<typename FixedPoint<T>::Integer> Resident<T>::materials_in_records(const CodedMaterials& coded) const {
  const unsigned entry_size = sizeof(Entry<T>) / (form().wide_table ? sizeof(T) : 1);
  std::vector<typename FixedPoint<T>::Integer> halves;
  for (std::uint32_t i = 0; i < task_->body->materials.size(); ++i)
    halves.push_back(has_codes(features_) ? coded.codes[i].stiffness : (i + 1) * entry_size);
  return halves;
}

template <class T>
void Resident<T>::pack_records(Record<T>* to, const CodedMaterials& coded) const {
  using Integer = typename FixedPoint<T>::Integer;
  const std::uint32_t unit = form().wide_offsets ? sizeof(T) : 1;
  const std::vector<Integer> materials = materials_in_records(coded);
  const std::span<const std::uint32_t> counted = arranged_->slot_of();
  for (const auto& [arrangement, springs, copies, first_mass, first_slot] : arranged_->blocks()) {
    std::ranges::transform(arrangement.slots, to + first_slot, [&](const Arrangement::Slot& slot) {
      return Record<T>{T(0), static_cast<Integer>(offset_in_chip<T>(arrangement, slot.other, features_) / unit)};
    });
    // in the order of the body's springs, which is twice as fast as the order of the slots
    for (std::size_t i = 0; i < arrangement.slot_of.size(); ++i) {
      const std::size_t number = springs.empty() ? i : springs[i];
      const Spring& spring = task_->body->springs[number];
      const std::uint32_t slot = first_slot + arrangement.slot_of[i];
      const auto length = static_cast<T>(spring.rest_length);
      to[slot].rest_length = counted[number] == slot ? length : -length;
      to[slot].packed |= materials[spring.material] << 16;
    }
  }
  std::fill_n(to + slots(), slots_read_ahead, Record<T>{});
}

/// Writes a number of each spring into its slots, and zeros into empty ones.
template <class T>
template <class Number, class Of>
void Resident<T>::pack_by_slot(const Of& number_of, Number* to) const {
  std::fill_n(to, slots() + slots_read_ahead, Number(0));
  for (const auto& [arrangement, springs, copies, first_mass, first_slot] : arranged_->blocks())
    for (std::size_t i = 0; i < arrangement.slot_of.size(); ++i)
      to[first_slot + arrangement.slot_of[i]] = number_of(task_->body->springs[springs.empty() ? i : springs[i]]);
}

/// Writes the codes of materials, if springs carry codes, or else the entries of the table, and the coefficients of the
/// dashpots.
template <class T>
void Resident<T>::pack_materials(const Regions& host, const CodedMaterials& coded) const {
  const bool codes = has_codes(features_);
  if (waves_in(slots()) > 0)
    pack_by_slot<std::uint32_t>([&](const Spring& spring) { return coded.codes[spring.material].wave; },
                                waves_.in(host.input));
  const std::vector<Material> materials =
      codes ? rounded_materials(*task_->body, coded) : simulated_materials(*task_->body, features_.materials);
  if (!codes) {
    actuators_.in(host.input)[0] = {};
    std::transform(materials.begin(), materials.end(), actuators_.in(host.input) + 1,
                   [&](const Material& material) { return actuator_of(material, range().resolution); });
  }
  if (!features_.dashpots) return;
  std::vector<T> of_entries(materials.size() + 1);
  pack_dashpots(*task_->body, materials, range().resolution, of_entries.data());
  if (codes)
    pack_by_slot<T>([&](const Spring& spring) { return of_entries[spring.material + 1]; },
                    coefficients_.in(host.input));
  else
    std::ranges::copy(of_entries, coefficients_.in(host.input));
}

template <class T>
void Resident<T>::pack_masses(const Regions& host) const {
  std::fill_n(mass_.in(host.input), padded_masses(), T(0));
  std::fill_n(inverse_mass_.in(host.input), padded_masses(), T(0));
  for (const Section<T>& plane : motion_) std::fill_n(plane.in(host.state), padded_masses(), T(0));
  if (features_.dashpots)
    for (const Section<T>& plane : dashpot_velocity_) std::fill_n(plane.in(host.state), padded_masses(), T(0));
  for (std::size_t i = 0; i < task_->body->masses.size(); ++i) {
    const std::uint32_t index = arranged_->index_of()[i];
    const double mass = task_->body->masses[i].mass;
    mass_.in(host.input)[index] = static_cast<T>(mass);
    // an inverse mass of 0 keeps a mass of 0 kg where it is
    inverse_mass_.in(host.input)[index] = static_cast<T>(mass > 0 ? 1 / mass : 0);
    const Vec3 x = task_->state->position[i], v = task_->state->velocity[i];
    const double numbers[] = {x.x, x.y, x.z, v.x, v.y, v.z};
    for (std::size_t c = 0; c < 6; ++c) motion_[c].in(host.state)[index] = static_cast<T>(numbers[c]);
    if (!features_.dashpots) continue;
    const Vec3 u = dashpot_velocities_of(*task_)[i];
    const double of_dashpots[] = {u.x, u.y, u.z};
    for (std::size_t c = 0; c < 3; ++c) dashpot_velocity_[c].in(host.state)[index] = static_cast<T>(of_dashpots[c]);
  }
}

template <class T>
std::vector<Vec3> Resident<T>::dashpot_velocities(const Regions& host) const {
  std::vector<Vec3> velocities;
  for (const std::uint32_t index : arranged_->index_of())
    velocities.push_back({dashpot_velocity_[0].in(host.state)[index], dashpot_velocity_[1].in(host.state)[index],
                          dashpot_velocity_[2].in(host.state)[index]});
  return velocities;
}

/// Writes what differs from block to block, apart from masses and springs.
template <class T>
void Resident<T>::pack_blocks(const Regions& host) const {
  using Integer = typename FixedPoint<T>::Integer;
  std::uint32_t* first_group = first_group_.in(host.input);
  std::uint32_t* group_ends = group_ends_.in(host.input);
  HaloCopy* to = copies_.in(host.input);
  const auto& blocks = arranged_->blocks();
  for (std::size_t number = 0; number < blocks.size(); ++number) {
    const auto& [arrangement, springs, copies, first_mass, first_slot] = blocks[number];
    first_group = std::copy(arrangement.first_group.begin(), arrangement.first_group.end(), first_group);
    group_ends = std::copy(arrangement.group_ends.begin(), arrangement.group_ends.end(), group_ends);
    std::transform(arrangement.magic_numbers.begin(), arrangement.magic_numbers.end(),
                   start_.in(host.input) + first_mass,
                   [](std::int32_t count) { return static_cast<Integer>(count) * FixedPoint<T>::magic_bits; });
    for (const ArrangedBody::Copy& copy : copies)
      *to++ = {offset_in_chip<T>(arrangement, copy.from, features_),
               offset_in_chip<T>(blocks[copy.block].arrangement, copy.to, features_) | copy.block << halo_rank_shift};
    answer_.in(host.state)[number] = {.fallen = task_->course->fallen};
  }
}

/// Changes the description of the first block, with the arrays of all blocks, to that of block `number`.
template <class T>
void Resident<T>::place_block(std::size_t number, ResidentBody<T>& body) const {
  const auto& blocks = arranged_->blocks();
  const auto& [arrangement, springs, copies, first_mass, first_slot] = blocks[number];
  const auto at = [](auto*& array, std::size_t first) {
    if (array != nullptr) array += first;
  };
  for (std::size_t b = 0; b < number; ++b) body.halo_copies += blocks[b].copies.size();
  at(body.records, first_slot);
  at(body.waves, first_slot);
  if (has_codes(features_)) at(body.coefficients, first_slot);
  at(body.first_group, number * shape().block);
  at(body.group_ends, number * shape().block * shape().chunks);
  at(body.mass, first_mass);
  at(body.inverse_mass, first_mass);
  at(body.start, first_mass);
  for (T** plane : {&body.motion.x, &body.motion.y, &body.motion.z, &body.motion.vx, &body.motion.vy, &body.motion.vz,
                    &body.dashpot_velocity.x, &body.dashpot_velocity.y, &body.dashpot_velocity.z})
    at(*plane, first_mass);
  at(body.stress, first_slot);
  at(body.recent_stress, first_slot);
  at(body.peak, first_slot);
  at(body.powers, first_slot);
  at(body.tensions, first_slot);
  at(body.answer, number);
  body.groups = arrangement.groups;
  body.halo_offset = static_cast<std::uint32_t>(bytes_of_groups<T>(arrangement.groups, features_));
  body.halo_groups = arrangement.halo_groups;
  body.halo_masses = arrangement.halo_masses;
  body.copies = static_cast<std::uint32_t>(copies.size());
  at(body.sampling.mass_share, first_mass);
  at(body.sampling.contact_steps, first_mass);
  body.sampling.first_mass = first_mass;
  body.sampling.first_slot = first_slot;
}

template <class T>
void Resident<T>::pack(const Regions& host, const Regions& device, const Scene& scene, ResidentBody<T>* to) const {
  const CodedMaterials coded = has_codes(features_) ? CodedMaterials(*task_->body) : CodedMaterials();
  const MaterialUnits& units = coded.units;
  pack_records(records_.in(host.input), coded);
  pack_masses(host);
  pack_blocks(host);
  pack_materials(host, coded);
  const ResidentBody<T> body{
      .constants = step_constants<T>(scene, task_->dt),
      .units = {.stiffness = static_cast<T>(units.stiffness / range().resolution),
                .amplitude = static_cast<T>(units.amplitude / (1 << amplitude_shift)),
                .angular_frequency = static_cast<T>(full_turn * units.frequency),
                .frequency = units.frequency},
      .records = records_.in(device.input),
      .waves = waves_.in(device.input),
      .first_group = first_group_.in(device.input),
      .group_ends = group_ends_.in(device.input),
      .actuators = actuators_.in(device.input),
      .coefficients = coefficients_.in(device.input),
      .mass = mass_.in(device.input),
      .inverse_mass = inverse_mass_.in(device.input),
      .start = start_.in(device.input),
      .motion = {motion_[0].in(device.state), motion_[1].in(device.state), motion_[2].in(device.state),
                 motion_[3].in(device.state), motion_[4].in(device.state), motion_[5].in(device.state)},
      .dashpot_velocity = {dashpot_velocity_[0].in(device.state), dashpot_velocity_[1].in(device.state),
                           dashpot_velocity_[2].in(device.state)},
      .stress = stress_.in(device.sums),
      .recent_stress = recent_stress_.in(device.sums),
      .peak = peak_.in(device.sums),
      .powers = powers_.in(device.sums),
      .tensions = tensions_.in(device.sums),
      .answer = answer_.in(device.state),
      .piece = run_piece_of(*task_),
      .resolution = range().resolution,
      .largest_force = static_cast<T>(range().largest / range().resolution),
      .chunks = shape().chunks,
      .entries = static_cast<std::uint32_t>(task_->body->materials.size() + 1),
      .warps = shape().warps,
      .cut_warps = shape().cut_warps,
      .rows = shape().rows,
      .cut_rows = shape().cut_rows,
      .table_steps = chip_.table_steps,
      .table_offset = static_cast<std::uint32_t>(chip_.table_offset),
      .rate_offset = static_cast<std::uint32_t>(chip_.rate_offset),
      .coefficient_offset = static_cast<std::uint32_t>(chip_.coefficient_offset),
      .record_offset = static_cast<std::uint32_t>(chip_.record_offset),
      .wave_offset = static_cast<std::uint32_t>(chip_.wave_offset),
      .halo_copies = copies_.in(device.input),
      .sampling = samples_.pack(arranged_->index_of(), host, device)};
  for (std::size_t number = 0; number < blocks(); ++number) {
    to[number] = body;
    place_block(number, to[number]);
  }
}

template <class T>
void Resident<T>::unpack(const Regions& host, Recording recording, Task& task) const {
  if (!answer_.in(host.state)->diverged) unpack_springs(host, task);
  read_answer(*answer_.in(host.state), recording, task);
  if (task.course && predicts_dashpot_velocities(features_)) task.course->dashpot_velocity = dashpot_velocities(host);
  task.preparation = arranged_;
  const auto at = [&](std::size_t plane, std::uint32_t index) -> double {
    return motion_[plane].in(host.state)[index];
  };
  for (std::size_t i = 0; i < task.body->masses.size(); ++i) {
    const std::uint32_t index = arranged_->index_of()[i];
    task.state->position[i] = {at(0, index), at(1, index), at(2, index)};
    task.state->velocity[i] = {at(3, index), at(4, index), at(5, index)};
  }
}

template <class T>
void Resident<T>::unpack_samples(std::uint64_t range, const Regions& host, Task& task) const {
  samples_.unpack(range, arranged_->index_of(), arranged_->slot_of(), host, task);
}

/// Reads the records of the springs into the task's lists, which have the right size. Needs the task's course.
template <class T>
void Resident<T>::unpack_springs(const Regions& host, Task& task) const {
  const auto steps = static_cast<double>(task.steps);
  const auto read = [&](std::vector<double>& to, const auto& number_at) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = number_at(arranged_->slot_of()[i]);
  };
  read(task.stress, [&](std::size_t slot) { return stress_.in(host.sums)[slot] / steps; });
  read(task.peak_force,
       [&](std::size_t slot) { return range().resolution * std::bit_cast<T>(peak_.in(host.sums)[slot]); });
  read(task.muscle_work, [&](std::size_t slot) { return range().resolution * task.dt * powers_.in(host.sums)[slot]; });
  read(task.tension, [&](std::size_t slot) { return range().resolution * tensions_.in(host.sums)[slot] / steps; });
}

template class Resident<float>;
template class Resident<double>;

}  // namespace evodevo::cuda
