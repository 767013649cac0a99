#include "cuda/layout/resident.hpp"

#include <algorithm>

namespace evodevo::cuda {
namespace {

constexpr std::size_t longest_table = 50;        // steps; each refill costs a little
constexpr std::size_t table_bytes = 8 << 10;     // intended largest size of a table
constexpr std::size_t reserved_bytes = 1 << 10;  // of shared memory, for the kernel and the system
constexpr std::size_t reserved_in_a_cluster = 5 << 8;

std::size_t aligned(std::size_t size) { return (size + 15) / 16 * 16; }

// more blocks than necessary only for bodies of so many masses, if each block has enough of them, on average, and only
// for runs so long that they repay arranging the body anew
constexpr std::size_t worth_a_cluster = 300, least_masses = 62;
constexpr std::uint64_t steps_worth_a_cluster = 10000;

/// Whether the arrangement of a body may depend on the number of bodies. In other cases, the rounding of work or of
/// samples would depend on it.
bool is_free(const Features& features) { return !features.work && !features.float64; }

/// The largest size of a cluster of at most so many blocks.
unsigned largest_cluster_of(std::size_t blocks) {
  return *std::prev(
      std::upper_bound(std::begin(cluster_sizes), std::end(cluster_sizes), std::max<std::size_t>(blocks, 1)));
}

/// What a body with these features is arranged for.
Target target_of(const Body& body, const Features& features, const Room& room) {
  const bool is_filled = features.actuation && !has_codes(features);
  return {largest_block(features.float64), is_free(features) ? room.at_once : Target::many,
          is_filled ? body.materials.size() + 1 : 0};
}

}  // namespace

template <class T>
std::size_t Resident<T>::largest_chip(std::size_t shared_bytes, bool in_a_cluster) {
  return shared_bytes - (in_a_cluster ? reserved_in_a_cluster : reserved_bytes);
}

template <class T>
std::optional<Resident<T>> Resident<T>::arrange(const Task& task, const Features& features, const Room& room,
                                                std::uint64_t spans_per_range) {
  const auto earlier = std::dynamic_pointer_cast<const ArrangedBody>(task.preparation);
  const unsigned wanted = wanted_blocks(task, features, room);
  // on what, apart from the body, the number of blocks depends that it needs; 0 if it may get more
  const std::size_t needs = wanted > 1 ? 0 : needs_of(features, room);
  unsigned first = wanted;
  if (needs > 0 && earlier && earlier->needs() == needs && earlier->is_of(*task.body))
    first = static_cast<unsigned>(earlier->blocks().size());
  // each block has a mass
  const unsigned last = largest_cluster_of(std::min<std::size_t>(room.largest_cluster, task.body->masses.size()));
  for (const unsigned blocks : cluster_sizes) {
    if (blocks > last) break;
    if (blocks < first) continue;
    const std::size_t chip = largest_chip(room.shared_bytes, blocks > 1);
    const bool is_last = blocks == last;
    if (!may_suffice(task, features, blocks, is_last, chip)) continue;
    Resident resident(task, features, blocks, target_of(*task.body, features, room), needs);
    resident.divide_chip(true, chip);
    if (resident.chip_.size > chip || !(is_last || resident.is_fast(chip))) continue;
    resident.divide_chip(features.work, chip);
    if (features.sampled)
      resident.samples_ = SampleLayout(task, spans_per_range, resident.padded_masses(), resident.slots());
    resident.reserve();
    return resident;
  }
  return std::nullopt;
}

/// The number of blocks that a body should get, even if it needs fewer.
template <class T>
unsigned Resident<T>::wanted_blocks(const Task& task, const Features& features, const Room& room) {
  const std::uint64_t steps = task.course->steps + task.steps + task.later_steps;
  if (!is_free(features) || steps < steps_worth_a_cluster) return 1;
  const std::size_t masses = task.body->masses.size();
  const auto most = static_cast<unsigned>(masses < worth_a_cluster ? 1 : masses / least_masses);
  return largest_cluster_of(std::min({room.wanted_blocks, room.largest_cluster, most}));
}

/// A number other than 0 that is different if a body may need a different number of blocks.
template <class T>
std::size_t Resident<T>::needs_of(const Features& features, const Room& room) {
  std::size_t needs = room.shared_bytes * 32 + room.largest_cluster;
  for (const bool feature : {features.float64, features.dashpots, has_codes(features), features.actuation})
    needs = 2 * needs + feature;
  return 8 * needs + static_cast<std::size_t>(features.method);
}

/// Whether more blocks would not be faster: the springs are on the chip and sums in registers; or the table, of which
/// each block needs a copy, is so large that more blocks have hardly more room; or the body is in double precision,
/// where reading springs from the device's memory costs less than a cluster.
template <class T>
bool Resident<T>::is_fast(std::size_t chip) const {
  const std::size_t table =
      (has_codes(features_) ? chip_.record_offset : chip_.coefficient_offset) - chip_.table_offset;
  return features_.float64 || table > chip / 4 || (records_on_chip_ && shape().chunks == 1);
}

/// A quick test before the work of arranging: whether a block's even share of the masses, a table of one step and, if
/// is_fast() will ask for it, of the springs may fit.
template <class T>
bool Resident<T>::may_suffice(const Task& task, const Features& features, unsigned blocks, bool is_last,
                              std::size_t chip) {
  const std::size_t entries = has_codes(features) ? 0 : task.body->materials.size() + 1;
  if (entries * sizeof(Entry<T>) > largest_offset * sizeof(T)) return false;
  const std::size_t groups = (task.body->masses.size() + lanes * blocks - 1) / (lanes * blocks);
  const std::size_t table = entries * (sizeof(Entry<T>) + sizeof(T));
  std::size_t least = bytes_of_groups<T>(groups, features) + table;
  if (!is_last && !features.float64 && 2 * table < chip / 4)
    least += task.body->springs.size() / blocks * sizeof(Record<T>);
  return least <= chip;
}

template <class T>
Resident<T>::Resident(const Task& task, const Features& features, unsigned blocks, const Target& target,
                      std::size_t needs)
    : task_(&task),
      features_(features),
      arranged_(ArrangedBody::of(*task.body, blocks, target, task.preparation,
                                 features.work ? ArrangedBody::Keep::nothing : ArrangedBody::Keep::all, needs)) {}

/// The memory of the masses and the halo of the block that needs most, bytes.
template <class T>
std::size_t Resident<T>::masses_bytes() const {
  std::size_t most = 0;
  for (const auto& block : arranged_->blocks())
    most = std::max(most, bytes_of_groups<T>(block.arrangement.groups, features_) +
                              block.arrangement.halo_groups * halo_group_size<T>(features_));
  return most;
}

/// Divides shared memory: masses, table of lengths, rates (if `with_rates`) and, if there is room, springs.
template <class T>
void Resident<T>::divide_chip(bool with_rates, std::size_t shared_bytes) {
  const bool codes = has_codes(features_);
  const std::size_t entries = task_->body->materials.size() + 1;
  // bytes of a row: the material's entries, or one reading of the clock
  const std::size_t lengths = codes ? sizeof(std::uint32_t) : entries * sizeof(Entry<T>);
  const std::size_t rates = with_rates && !codes ? entries * sizeof(T) : 0;
  const std::size_t masses = masses_bytes(), slots = shape().slots() + slots_read_ahead;
  const std::size_t coefficients = aligned(coefficients_in(slots) * sizeof(T)), of_table = codes ? 0 : coefficients;
  const std::size_t records = slots * sizeof(Record<T>), waves = waves_in(slots) * sizeof(std::uint32_t);
  const std::size_t springs = records + waves + coefficients - of_table;
  const MethodForm& method = form_of(features_.method);
  // whatever is recorded: sums in registers have as many terms as the table has steps, and the number of terms decides
  // how a sum is rounded
  const std::size_t steps = std::clamp<std::size_t>(table_bytes / lengths / method.rows_per_step, 1, longest_table);
  // the clock is read one row ahead
  const std::size_t rows = (features_.actuation ? method.rows(static_cast<unsigned>(steps)) : 1) + (codes ? 1 : 0);
  records_on_chip_ = aligned(masses) + aligned(rows * (lengths + rates)) + 32 + of_table + springs <= shared_bytes;
  chip_.table_steps = static_cast<std::uint32_t>(steps);
  chip_.table_offset = aligned(masses);
  chip_.rate_offset = aligned(chip_.table_offset + rows * lengths);
  const std::size_t end_of_table = aligned(chip_.rate_offset + rows * rates);
  chip_.record_offset = end_of_table + of_table;
  chip_.wave_offset = chip_.record_offset + records;
  chip_.coefficient_offset = codes ? chip_.wave_offset + waves : end_of_table;
  chip_.size = chip_.record_offset + (records_on_chip_ ? springs : 0);
}

/// The number of waves for `slots` slots: none if materials come from a table or nothing is actuated.
template <class T>
std::size_t Resident<T>::waves_in(std::size_t slots) const {
  return has_codes(features_) && features_.actuation ? slots : 0;
}

/// The number of coefficients of dashpots: one for each slot, or for each entry of the table.
template <class T>
std::size_t Resident<T>::coefficients_in(std::size_t slots) const {
  if (!features_.dashpots) return 0;
  return has_codes(features_) ? slots : task_->body->materials.size() + 1;
}

template <class T>
void Resident<T>::reserve() {
  Extent input, state, sums;
  std::size_t copies = 0;
  for (const auto& block : arranged_->blocks()) copies += block.copies.size();
  records_ = input.add<Record<T>>(slots() + slots_read_ahead);
  waves_ = input.add<std::uint32_t>(waves_in(slots() + slots_read_ahead));
  first_group_ = input.add<std::uint32_t>(blocks() * shape().block);
  group_ends_ = input.add<std::uint32_t>(blocks() * shape().block * shape().chunks);
  copies_ = input.add<HaloCopy>(copies);
  actuators_ = input.add<Actuator>(has_codes(features_) ? 0 : task_->body->materials.size() + 1);
  coefficients_ = input.add<T>(coefficients_in(slots() + slots_read_ahead));
  mass_ = input.add<T>(padded_masses());
  inverse_mass_ = input.add<T>(padded_masses());
  start_ = input.add<typename FixedPoint<T>::Integer>(padded_masses());
  for (Section<T>& plane : motion_) plane = state.add<T>(padded_masses());
  for (Section<T>& plane : dashpot_velocity_) plane = state.add<T>(features_.dashpots ? padded_masses() : 0);
  answer_ = state.add<Answer>(blocks());
  stress_ = sums.add<double>(features_.stress ? slots() : 0);
  recent_stress_ = sums.add<T>(features_.stress && form().chunked ? slots() : 0);
  peak_ = sums.add<typename FixedPoint<T>::Integer>(features_.peak_force ? slots() : 0);
  powers_ = sums.add<double>(features_.muscle_work ? slots() : 0);
  tensions_ = sums.add<double>(features_.mean_tension ? slots() : 0);
  samples_.reserve(input, sums);
  sizes_ = {.descriptions = descriptions_bytes<ResidentBody<T>>(blocks()),
            .input = input.size(),
            .state = state.size(),
            .sums = sums.size(),
            .samples = samples_.bytes()};
}

template <class T>
ResidentForm Resident<T>::form() const {
  const unsigned unrolled = features_.stress && std::max(shape().rows, shape().cut_rows) <= rows_with_fast_stress
                                ? rows_with_fast_stress
                                : most_rows;
  return {
      .rows = shape().chunks > 1 ? rows_of_a_chunk : unrolled,
      .masses_per_thread = shape().masses_per_thread,
      .chunked = shape().chunks > 1,
      .records_on_chip = records_on_chip_,
      .wide_offsets = masses_bytes() > largest_offset,
      .wide_table = !has_codes(features_) && (task_->body->materials.size() + 1) * sizeof(Entry<T>) > largest_offset,
      .clustered = blocks() > 1};
}

template class Resident<float>;
template class Resident<double>;

}  // namespace evodevo::cuda
