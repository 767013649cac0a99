#include "cuda/layout/streamed.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

#include "analysis/colouring.hpp"
#include "analysis/computed_materials.hpp"
#include "cuda/layout/arrangement/arrangement.hpp"

namespace evodevo::cuda {

template <class T>
Streamed<T>::Streamed(const Task& task, const Features& features, std::size_t largest_chip,
                      std::uint64_t spans_per_range)
    : task_(&task),
      features_(features),
      chip_bytes_(form_of(features.method).points_on_chip * sizeof(Point<T>) * task.body->masses.size()),
      index_of_(indices_by_degree(Outline(*task.body))),
      first_row_(1),
      owned_joint_(task.body->springs.size()) {
  if (chip_bytes_ > largest_chip) chip_bytes_ = 0;
  const Body& body = *task.body;
  std::vector<std::uint32_t> degree(body.masses.size());
  for (const Spring& spring : body.springs) ++degree[index_of_[spring.a]], ++degree[index_of_[spring.b]];
  // the first mass of a group has its highest degree
  for (std::size_t i = 0; i < degree.size(); i += lanes) first_row_.push_back(first_row_.back() + degree[i]);

  std::vector<std::uint32_t> next(body.masses.size());
  for (std::size_t i = 0; i < owned_joint_.size(); ++i) {
    const std::uint32_t a = index_of_[body.springs[i].a];
    owned_joint_[i] = joint_at(a, next[a]++);
    ++next[index_of_[body.springs[i].b]];
  }
  if (form_of(features.method).coloured) colour_ = spring_colours(body);
  if (!colour_.empty()) colours_ = *std::max_element(colour_.begin(), colour_.end()) + 1;
  if (features.sampled) samples_ = SampleLayout(task, spans_per_range, masses(), joints());
  reserve();
}

template <class T>
void Streamed<T>::reserve() {
  const MethodForm& method = form_of(features_.method);
  const std::size_t entries = task_->body->materials.size() + 1, table = method.rows(guard_interval) * entries;
  Extent input, state, sums, scratch;
  rows_ = input.add<std::uint32_t>(first_row_.size());
  joints_ = input.add<Joint<T>>(joints());
  coloured_ = input.add<ColouredSpring<T>>(colour_.size());
  first_of_colour_ = input.add<std::uint32_t>(colours_ + 1);
  actuators_ = input.add<Actuator>(entries);
  dashpots_ = input.add<T>(features_.dashpots ? entries : 0);
  mass_ = input.add<T>(masses());
  inverse_mass_ = input.add<T>(masses());
  positions_ = state.add<Point<T>>(2 * masses());
  velocities_ = state.add<Point<T>>(masses());
  dashpot_velocities_ = state.add<Point<T>>(features_.dashpots && is_explicit(features_.method) ? 2 * masses() : 0);
  answer_ = state.add<Answer>(1);
  table_ = sums.add<Entry<T>>(table);
  rates_ = sums.add<T>(features_.work ? table : 0);
  stress_ = sums.add<double>(features_.stress ? joints() : 0);
  power_ = sums.add<double>(features_.work ? masses() : 0);
  peak_ = sums.add<T>(features_.peak_force ? joints() : 0);
  powers_ = sums.add<double>(features_.muscle_work ? joints() : 0);
  tensions_ = sums.add<double>(features_.mean_tension ? joints() : 0);
  scratch_ = scratch.add<T>(method.numbers_of_mass * masses() + method.numbers_of_joint * joints());
  samples_.reserve(input, sums);
  sizes_ = {descriptions_bytes<StreamedBody<T>>(1),
            input.size(),
            state.size(),
            sums.size(),
            scratch.size(),
            samples_.bytes()};
}

template <class T>
unsigned Streamed<T>::threads() const {
  if (is_explicit(features_.method)) return 128;
  // a colour has at most half as many springs as the body has masses, and on average about a quarter
  const std::uint32_t busy = form_of(features_.method).coloured ? masses() / 4 : masses();
  return std::clamp(std::bit_ceil(busy), lanes, lanes * largest_block(features_.float64));
}

template <class T>
unsigned Streamed<T>::steps_of_span(std::uint64_t span) const {
  if (span >= check_spans()) return 0;
  const std::uint64_t begin = span == 0 ? 0 : span * guard_interval - since_check();
  return static_cast<unsigned>(std::min(task_->steps, (span + 1) * guard_interval - since_check()) - begin);
}

template <class T>
void Streamed<T>::pack_joints(const Regions& host) const {
  Joint<T>* to = joints_.in(host.input);
  // an empty joint leads to its own mass and has entry 0, which belongs to no material
  for (std::uint32_t index = 0; index < lanes * (first_row_.size() - 1); ++index)
    for (std::uint32_t row = 0; row < first_row_[index / lanes + 1] - first_row_[index / lanes]; ++row)
      to[joint_at(index, row)] = {T(0), std::min(index, masses() - 1), 0, 0};
  std::vector<std::uint32_t> next(masses());
  for (const Spring& spring : task_->body->springs) {
    const std::uint32_t a = index_of_[spring.a], b = index_of_[spring.b];
    const auto length = static_cast<T>(spring.rest_length);
    to[joint_at(a, next[a]++)] = {length, b, spring.material + 1, 1};
    to[joint_at(b, next[b]++)] = {length, a, spring.material + 1, 0};
  }
}

/// Writes the springs sorted by colour; those of a colour in the body's order.
template <class T>
void Streamed<T>::pack_colours(const Regions& host) const {
  std::uint32_t* first = first_of_colour_.in(host.input);
  std::fill_n(first, colours_ + 1, 0u);
  for (const std::uint32_t colour : colour_) ++first[colour + 1];
  std::partial_sum(first, first + colours_ + 1, first);
  std::vector<std::uint32_t> next(first, first + colours_);
  for (std::uint32_t i = 0; i < colour_.size(); ++i) {
    const Spring& spring = task_->body->springs[i];
    coloured_.in(host.input)[next[colour_[i]]++] = {static_cast<T>(spring.rest_length), index_of_[spring.a],
                                                    index_of_[spring.b], spring.material + 1, owned_joint_[i]};
  }
}

template <class T>
StreamedBody<T> Streamed<T>::pack(const Regions& host, const Regions& device, const Scene& scene) const {
  const Body& body = *task_->body;
  std::copy(first_row_.begin(), first_row_.end(), rows_.in(host.input));
  pack_joints(host);
  pack_colours(host);
  actuators_.in(host.input)[0] = {};
  const std::vector<Material> materials = simulated_materials(body, features_.materials);
  std::transform(materials.begin(), materials.end(), actuators_.in(host.input) + 1,
                 [](const Material& material) { return actuator_of(material, 1); });
  if (features_.dashpots) pack_dashpots(body, materials, 1, dashpots_.in(host.input));
  const auto point = [](Vec3 v) {
    return Point<T>{static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z), T(0)};
  };
  for (std::size_t i = 0; i < body.masses.size(); ++i) {
    const std::uint32_t index = index_of_[i];
    const double mass = body.masses[i].mass;
    mass_.in(host.input)[index] = static_cast<T>(mass);
    // an inverse mass of 0 keeps a mass of 0 kg where it is
    inverse_mass_.in(host.input)[index] = static_cast<T>(mass > 0 ? 1 / mass : 0);
    positions_.in(host.state)[index] = point(task_->state->position[i]);
    velocities_.in(host.state)[index] = point(task_->state->velocity[i]);
    if (features_.dashpots && is_explicit(features_.method))
      dashpot_velocities_.in(host.state)[index] = point(dashpot_velocities_of(*task_)[i]);
  }
  *answer_.in(host.state) = {.fallen = task_->course->fallen};
  return {.constants = step_constants<T>(scene, task_->dt),
          .first_row = rows_.in(device.input),
          .joints = joints_.in(device.input),
          .coloured = coloured_.in(device.input),
          .first_of_colour = first_of_colour_.in(device.input),
          .actuators = actuators_.in(device.input),
          .dashpots = dashpots_.in(device.input),
          .mass = mass_.in(device.input),
          .inverse_mass = inverse_mass_.in(device.input),
          .positions = positions_.in(device.state),
          .velocities = velocities_.in(device.state),
          .dashpot_velocities = dashpot_velocities_.in(device.state),
          .scratch = scratch_.in(device.scratch),
          .table = table_.in(device.sums),
          .rates = rates_.in(device.sums),
          .stress = stress_.in(device.sums),
          .power = power_.in(device.sums),
          .peak = peak_.in(device.sums),
          .powers = powers_.in(device.sums),
          .tensions = tensions_.in(device.sums),
          .answer = answer_.in(device.state),
          .piece = run_piece_of(*task_),
          .masses = masses(),
          .entries = static_cast<std::uint32_t>(body.materials.size() + 1),
          .colours = colours_,
          .on_chip = chip_bytes_ > 0,
          .sampling = samples_.pack(index_of_, host, device)};
}

template <class T>
void Streamed<T>::unpack(const Regions& host, Recording recording, Task& task) const {
  const Answer& answer = *answer_.in(host.state);
  const std::uint64_t half = form_of(features_.method).passes(answer.steps, since_check()) % 2;
  read_answer(answer, recording, task);
  const Point<T>* positions = positions_.in(host.state) + half * masses();
  const Point<T>* velocities = velocities_.in(host.state);
  for (std::size_t i = 0; i < masses(); ++i) {
    const Point<T>&x = positions[index_of_[i]], &v = velocities[index_of_[i]];
    task.state->position[i] = {x.x, x.y, x.z};
    task.state->velocity[i] = {v.x, v.y, v.z};
  }
  if (task.course && predicts_dashpot_velocities(features_)) {
    const Point<T>* from = dashpot_velocities_.in(host.state) + half * masses();
    task.course->dashpot_velocity.clear();
    for (const std::uint32_t index : index_of_)
      task.course->dashpot_velocity.push_back({from[index].x, from[index].y, from[index].z});
  }
  if (task.status == Status::ok) unpack_springs(host, task);
}

template <class T>
void Streamed<T>::unpack_samples(std::uint64_t range, const Regions& host, Task& task) const {
  samples_.unpack(range, index_of_, owned_joint_, host, task);
}

/// Reads the records of the springs into the task's lists, which have the right size.
template <class T>
void Streamed<T>::unpack_springs(const Regions& host, Task& task) const {
  const auto steps = static_cast<double>(task.steps);
  const auto read = [&](std::vector<double>& to, const auto& number_at) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = number_at(owned_joint_[i]);
  };
  read(task.stress, [&](std::size_t joint) { return stress_.in(host.sums)[joint] / steps; });
  read(task.peak_force, [&](std::size_t joint) { return peak_.in(host.sums)[joint]; });
  read(task.muscle_work, [&](std::size_t joint) { return task.dt * powers_.in(host.sums)[joint]; });
  read(task.tension, [&](std::size_t joint) { return tensions_.in(host.sums)[joint] / steps; });
}

template class Streamed<float>;
template class Streamed<double>;

}  // namespace evodevo::cuda
