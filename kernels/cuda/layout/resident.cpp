#include "cuda/layout/resident.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace evodevo::cuda {
namespace {

constexpr std::size_t longest_table = 50;        // steps; each refill costs a little
constexpr std::size_t table_bytes = 8 << 10;     // intended largest size of a table
constexpr std::size_t reserved_bytes = 1 << 10;  // of shared memory, for the kernel and the system
constexpr std::size_t largest_offset = 0xffff;

std::size_t aligned(std::size_t size) { return (size + 15) / 16 * 16; }

template <class T>
std::size_t group_size(const Features& features) {
  return features.dashpots ? group_bytes<T, true> : group_bytes<T, false>;
}

template <class T>
std::size_t masses_bytes(std::size_t groups, const Features& features) {
  return (groups + 1) * group_size<T>(features);  // one more group, to which empty slots refer
}

/// An upper bound (N) of the force of a spring that stops two moving masses: 2 v sqrt(k m/2), with the largest speed v,
/// mass m and `stiffness` k (N/m) of the body.
double stopping_force(const Body& body, const State& state, double stiffness) {
  double speed = 0, mass = 0;
  for (const Vec3& v : state.velocity) speed = std::max(speed, norm(v));
  for (const Mass& m : body.masses) mass = std::max(mass, m.mass);
  return 2 * speed * std::sqrt(stiffness * mass / 2);
}

/// The force (N) of the strongest dashpot when one of its ends is stopped: at the largest speed of the state, or at
/// that of a fall by the body's own size. 0 without dashpots.
double landing_force(const Body& body, const State& state, const Scene& scene) {
  if (std::ranges::all_of(body.materials, [](const Material& material) { return material.damping == 0; })) return 0;
  double coefficient = 0, speed = 0;
  for (const Spring& spring : body.springs) coefficient = std::max(coefficient, body.damping(spring));
  if (coefficient == 0) return 0;
  for (const Vec3& v : state.velocity) speed = std::max(speed, norm(v));
  if (scene.gravity && scene.floor)
    speed += std::sqrt(2 * std::abs(scene.gravity->acceleration) * bounding_box(state.position).longest_side());
  return coefficient * speed;
}

}  // namespace

ArrangedBody::ArrangedBody(const Body& body, Arrangement arrangement_, unsigned largest_block)
    : arrangement(std::move(arrangement_)), outline_(body), largest_block_(largest_block) {}

std::shared_ptr<const ArrangedBody> ArrangedBody::of(const Body& body, unsigned largest_block,
                                                     const std::shared_ptr<const Preparation>& earlier) {
  const auto before = std::dynamic_pointer_cast<const ArrangedBody>(earlier);
  if (before && before->largest_block_ == largest_block) {
    if (before->outline_.fits(body)) return before;
    return std::make_shared<const ArrangedBody>(
        body, Arrangement(body, largest_block, before->arrangement, before->outline_), largest_block);
  }
  return std::make_shared<const ArrangedBody>(body, Arrangement(body, largest_block), largest_block);
}

template <class T>
ForceRange force_range(const Body& body, const State& state, const Scene& scene) {
  double weight = 0;
  if (scene.gravity)
    for (const Mass& mass : body.masses) weight += mass.mass * std::abs(scene.gravity->acceleration);
  double largest = weight, doubled = 0, damping = 0, strongest = 0;
  bool driven = false;
  std::vector<std::uint32_t> degree(body.masses.size());
  for (const Spring& spring : body.springs) {
    const Material& material = body.materials[spring.material];
    const double stiffness = body.stiffness(spring);
    const double length = spring.rest_length * (1 + std::abs(material.amplitude));
    const double strain = norm(state.position[spring.b] - state.position[spring.a]) - spring.rest_length;
    strongest = std::max(strongest, stiffness);
    doubled = std::max(doubled, std::abs(stiffness) * length);
    largest = std::max(largest, std::abs(stiffness) * 2 * std::abs(strain));
    driven = driven || material.amplitude * material.frequency != 0;
    damping = std::max(damping, material.damping);
    ++degree[spring.a], ++degree[spring.b];
  }
  largest = std::max({largest, stopping_force(body, state, strongest), driven ? 2 * doubled : doubled});
  largest = std::max(largest * (1 + 2 * damping), largest + landing_force(body, state, scene));
  ForceRange range;
  const std::uint32_t terms = degree.empty() ? 1 : std::max(1u, *std::max_element(degree.begin(), degree.end()));
  // a margin of one percent for rounding of the force itself
  const double units = 0.99 * std::min(FixedPoint<T>::largest_term, FixedPoint<T>::largest_sum / terms);
  if (largest > 0 && std::isfinite(largest)) range.resolution = std::exp2(std::ceil(std::log2(largest / units)));
  range.largest = units * range.resolution;
  return range;
}

template ForceRange force_range<float>(const Body&, const State&, const Scene&);
template ForceRange force_range<double>(const Body&, const State&, const Scene&);

template <class T>
std::size_t Resident<T>::largest_chip(std::size_t shared_bytes) {
  return shared_bytes - reserved_bytes;
}

template <class T>
std::optional<Resident<T>> Resident<T>::arrange(const Task& task, const Features& features, std::size_t shared_bytes,
                                                std::uint64_t spans_per_range) {
  // a quick test before the work of arranging: whether the masses and a table of one step fit
  const std::size_t entries = has_codes(features) ? 0 : task.body->materials.size() + 1;
  const std::size_t groups = (task.body->masses.size() + lanes - 1) / lanes;
  const std::size_t least = masses_bytes<T>(groups, features) + entries * (sizeof(Entry<T>) + sizeof(T));
  if (least > largest_chip(shared_bytes) || entries * sizeof(Entry<T>) > largest_offset * sizeof(T))
    return std::nullopt;
  Resident resident(task, features);
  const std::size_t chip = largest_chip(shared_bytes);
  resident.divide_chip(true, chip);
  if (resident.chip_.size > chip) return std::nullopt;
  resident.divide_chip(features.work, chip);
  if (features.samples)
    resident.samples_ = SampleLayout(task, spans_per_range, resident.padded_masses(), resident.slots());
  resident.reserve();
  return resident;
}

template <class T>
Resident<T>::Resident(const Task& task, const Features& features)
    : task_(&task),
      features_(features),
      arranged_(ArrangedBody::of(*task.body, largest_block(features.float64), task.preparation)) {}

/// Divides shared memory: masses, table of lengths, rates (if `with_rates`) and, if there is room, springs.
template <class T>
void Resident<T>::divide_chip(bool with_rates, std::size_t shared_bytes) {
  const bool codes = has_codes(features_);
  const std::size_t entries = task_->body->materials.size() + 1;
  // bytes of a row: the material's entries, or one reading of the clock
  const std::size_t lengths = codes ? sizeof(std::uint32_t) : entries * sizeof(Entry<T>);
  const std::size_t rates = with_rates && !codes ? entries * sizeof(T) : 0;
  const std::size_t dashpots = aligned(features_.dashpots ? entries * sizeof(T) : 0);
  const std::size_t masses = masses_bytes<T>(arrangement().groups, features_), slots = arrangement().shape.slots();
  const std::size_t records = slots * sizeof(Record<T>), waves = waves_in(slots) * sizeof(std::uint32_t);
  const MethodForm& method = form_of(features_.method);
  // whatever is recorded: sums in registers have as many terms as the table has steps, and the number of terms decides
  // how a sum is rounded
  const std::size_t steps = std::clamp<std::size_t>(table_bytes / lengths / method.rows_per_step, 1, longest_table);
  // the clock is read one row ahead
  const std::size_t rows = (features_.actuation ? method.rows(static_cast<unsigned>(steps)) : 1) + (codes ? 1 : 0);
  records_on_chip_ =
      aligned(masses) + aligned(rows * (lengths + rates)) + 32 + dashpots + records + waves <= shared_bytes;
  chip_.table_steps = static_cast<std::uint32_t>(steps);
  chip_.table_offset = aligned(masses);
  chip_.rate_offset = aligned(chip_.table_offset + rows * lengths);
  chip_.dashpot_offset = aligned(chip_.rate_offset + rows * rates);
  chip_.record_offset = chip_.dashpot_offset + dashpots;
  chip_.wave_offset = chip_.record_offset + records;
  chip_.size = chip_.record_offset + (records_on_chip_ ? records + waves : 0);
}

/// The number of waves for `slots` slots: none if materials come from a table or nothing is actuated.
template <class T>
std::size_t Resident<T>::waves_in(std::size_t slots) const {
  return has_codes(features_) && features_.actuation ? slots : 0;
}

template <class T>
void Resident<T>::reserve() {
  Extent input, state, sums;
  records_ = input.add<Record<T>>(arrangement().slots.size());
  waves_ = input.add<std::uint32_t>(waves_in(arrangement().slots.size()));
  first_group_ = input.add<std::uint32_t>(arrangement().first_group.size());
  group_ends_ = input.add<std::uint32_t>(arrangement().group_ends.size());
  actuators_ = input.add<Actuator>(task_->body->materials.size() + 1);
  dashpots_ = input.add<T>(features_.dashpots ? task_->body->materials.size() + 1 : 0);
  mass_ = input.add<T>(padded_masses());
  inverse_mass_ = input.add<T>(padded_masses());
  start_ = input.add<typename FixedPoint<T>::Integer>(padded_masses());
  for (Section<T>& plane : motion_) plane = state.add<T>(padded_masses());
  for (Section<T>& plane : dashpot_velocity_) plane = state.add<T>(features_.dashpots ? padded_masses() : 0);
  answer_ = state.add<Answer>(1);
  stress_ = sums.add<double>(features_.stress ? arrangement().slots.size() : 0);
  recent_stress_ = sums.add<T>(features_.stress && form().chunked ? arrangement().slots.size() : 0);
  peak_ = sums.add<typename FixedPoint<T>::Integer>(features_.peak_force ? arrangement().slots.size() : 0);
  powers_ = sums.add<double>(features_.muscle_work ? arrangement().slots.size() : 0);
  tensions_ = sums.add<double>(features_.tension ? arrangement().slots.size() : 0);
  samples_.reserve(input, sums);
  sizes_ = {input.size(), state.size(), sums.size(), 0, samples_.bytes()};
}

template <class T>
ResidentForm Resident<T>::form() const {
  const Shape& shape = arrangement().shape;
  return {
      .rows = shape.rows,
      .masses_per_thread = shape.masses_per_thread,
      .chunked = shape.chunks > 1,
      .records_on_chip = records_on_chip_,
      .wide_offsets = masses_bytes<T>(arrangement().groups, features_) > largest_offset,
      .wide_table = !has_codes(features_) && (task_->body->materials.size() + 1) * sizeof(Entry<T>) > largest_offset};
}

/// The high half of Record::packed for each material.
template <class T>
std::vector<typename FixedPoint<T>::Integer> Resident<T>::materials_in_records(const MaterialUnits& units) const {
  const std::vector<Material>& materials = task_->body->materials;
  const unsigned entry_size = sizeof(Entry<T>) / (form().wide_table ? sizeof(T) : 1);
  std::vector<typename FixedPoint<T>::Integer> halves;
  for (std::uint32_t i = 0; i < materials.size(); ++i)
    halves.push_back(has_codes(features_) ? code_of(materials[i], units).stiffness : (i + 1) * entry_size);
  return halves;
}

template <class T>
void Resident<T>::pack_records(Record<T>* to, const MaterialUnits& units) const {
  using Integer = typename FixedPoint<T>::Integer;
  const std::size_t unit = form().wide_offsets ? sizeof(T) : 1;
  const std::size_t group = group_size<T>(features_);
  const auto offset_of = [&](std::uint32_t index) {
    return static_cast<Integer>((index / lanes * group + index % lanes * sizeof(T)) / unit);
  };
  const std::vector<Integer> materials = materials_in_records(units);
  const std::vector<Arrangement::Slot>& slots = arrangement().slots;
  for (std::size_t slot = 0; slot < slots.size(); ++slot)
    if (slots[slot].spring == Arrangement::none) to[slot] = {T(0), offset_of(slots[slot].other)};
  // in the order of the body's springs, which is twice as fast as the order of the slots
  for (std::size_t i = 0; i < task_->body->springs.size(); ++i) {
    const Spring& spring = task_->body->springs[i];
    const std::uint32_t slot = arrangement().slot_of[i];
    to[slot] = {static_cast<T>(spring.rest_length), offset_of(slots[slot].other) | materials[spring.material] << 16};
  }
}

template <class T>
void Resident<T>::pack_waves(std::uint32_t* to, const MaterialUnits& units) const {
  std::vector<std::uint32_t> waves;
  for (const Material& material : task_->body->materials) waves.push_back(code_of(material, units).wave);
  for (const Arrangement::Slot& slot : arrangement().slots)
    *to++ = slot.spring == Arrangement::none ? 0 : waves[task_->body->springs[slot.spring].material];
}

template <class T>
void Resident<T>::pack_masses(const Regions& host) const {
  std::fill_n(mass_.in(host.input), padded_masses(), T(0));
  std::fill_n(inverse_mass_.in(host.input), padded_masses(), T(0));
  for (const Section<T>& plane : motion_) std::fill_n(plane.in(host.state), padded_masses(), T(0));
  if (features_.dashpots)
    for (const Section<T>& plane : dashpot_velocity_) std::fill_n(plane.in(host.state), padded_masses(), T(0));
  for (std::size_t i = 0; i < task_->body->masses.size(); ++i) {
    const std::uint32_t index = arrangement().index_of[i];
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
  for (const std::uint32_t index : arrangement().index_of)
    velocities.push_back({dashpot_velocity_[0].in(host.state)[index], dashpot_velocity_[1].in(host.state)[index],
                          dashpot_velocity_[2].in(host.state)[index]});
  return velocities;
}

template <class T>
ResidentBody<T> Resident<T>::pack(const Regions& host, const Regions& device, const Scene& scene) const {
  using Integer = typename FixedPoint<T>::Integer;
  const MaterialUnits units = has_codes(features_) ? material_units(*task_->body) : MaterialUnits{};
  pack_records(records_.in(host.input), units);
  if (waves_in(slots()) > 0) pack_waves(waves_.in(host.input), units);
  pack_masses(host);
  std::copy(arrangement().first_group.begin(), arrangement().first_group.end(), first_group_.in(host.input));
  std::copy(arrangement().group_ends.begin(), arrangement().group_ends.end(), group_ends_.in(host.input));
  std::transform(arrangement().magic_numbers.begin(), arrangement().magic_numbers.end(), start_.in(host.input),
                 [](std::int32_t count) { return static_cast<Integer>(count) * FixedPoint<T>::magic_bits; });
  actuators_.in(host.input)[0] = {};
  const std::vector<Material> materials = simulated_materials(*task_->body, features_.materials);
  std::transform(materials.begin(), materials.end(), actuators_.in(host.input) + 1,
                 [&](const Material& material) { return actuator_of(material, range().resolution); });
  if (features_.dashpots) pack_dashpots(*task_->body, materials, range().resolution, dashpots_.in(host.input));
  *answer_.in(host.state) = {.fallen = task_->course->fallen};
  return {.constants = step_constants<T>(scene, task_->dt),
          .units = {.stiffness = static_cast<T>(units.stiffness / range().resolution),
                    .amplitude = static_cast<T>(units.amplitude / (1 << amplitude_shift)),
                    .angular_frequency = static_cast<T>(full_turn * units.frequency),
                    .frequency = units.frequency},
          .records = records_.in(device.input),
          .waves = waves_.in(device.input),
          .first_group = first_group_.in(device.input),
          .group_ends = group_ends_.in(device.input),
          .actuators = actuators_.in(device.input),
          .dashpots = dashpots_.in(device.input),
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
          .groups = arrangement().groups,
          .warps = arrangement().shape.warps,
          .chunks = arrangement().shape.chunks,
          .entries = static_cast<std::uint32_t>(task_->body->materials.size() + 1),
          .table_steps = chip_.table_steps,
          .table_offset = static_cast<std::uint32_t>(chip_.table_offset),
          .rate_offset = static_cast<std::uint32_t>(chip_.rate_offset),
          .dashpot_offset = static_cast<std::uint32_t>(chip_.dashpot_offset),
          .record_offset = static_cast<std::uint32_t>(chip_.record_offset),
          .wave_offset = static_cast<std::uint32_t>(chip_.wave_offset),
          .sampling = samples_.pack(arrangement().index_of, host, device)};
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
    const std::uint32_t index = arrangement().index_of[i];
    task.state->position[i] = {at(0, index), at(1, index), at(2, index)};
    task.state->velocity[i] = {at(3, index), at(4, index), at(5, index)};
  }
}

template <class T>
void Resident<T>::unpack_samples(std::uint64_t range, const Regions& host, Task& task) const {
  samples_.unpack(range, arrangement().index_of, arrangement().slot_of, host, task);
}

/// Reads the records of the springs into the task's lists, which have the right size. Needs the task's course.
template <class T>
void Resident<T>::unpack_springs(const Regions& host, Task& task) const {
  const auto steps = static_cast<double>(task.steps);
  const auto read = [&](std::vector<double>& to, const auto& number_at) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = number_at(arrangement().slot_of[i]);
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
