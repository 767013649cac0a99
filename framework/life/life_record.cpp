#include "life/life_record.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>

#include "life/edits.hpp"

namespace evodevo {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie in memory");

/// Bits that say whether rest lengths are scaled and whether Change::lengths_given is true. They come after the bits
/// for the kinds of edits that have causes.
constexpr std::uint32_t scaling_bit = 1u << edit_kinds.size(), lengths_given_bit = scaling_bit << 1;

/// Calls `each` with the cause of every edit of a kind, in the order of the edits.
void for_each_cause(auto& edits, EditKind kind, const auto& each) {
  const auto in = [&](auto& list) {
    for (auto& edit : list) each(edit.cause);
  };
  switch (kind) {
    case EditKind::removed_spring:
      return in(edits.removed_springs);
    case EditKind::removed_mass:
      return in(edits.removed_masses);
    case EditKind::changed_spring:
      return in(edits.changed_springs);
    case EditKind::new_mass:
      return in(edits.new_masses);
    case EditKind::new_spring:
      return in(edits.new_springs);
  }
}

/// Appends changes to a string of bytes. A whole number is written with seven bits in each byte, the lowest bits first;
/// the eighth bit says whether more bytes follow.
class Writer {
 public:
  Writer(std::string& bytes, MaterialNumbers& materials) : bytes_(bytes), materials_(materials) {}

  void write(const Change& change) {
    const Edits& edits = change.edits;
    whole(change.cycle);
    whole(change.op ? *change.op + 1 : 0);
    ascending_indices(edits.removed_masses);
    ascending_indices(edits.removed_springs);
    whole(edits.changed_springs.size());
    for (const ChangedSpring& spring : edits.changed_springs) changed(spring);
    whole(edits.new_masses.size());
    for (const NewMass& mass : edits.new_masses) {
      raw(mass.position), raw(mass.mass.value());
      whole(static_cast<std::uint64_t>(mass.material - no_material));
      whole(mass.mother ? std::uint64_t{*mass.mother} + 1 : 0);
      raw(mass.identity.value());
    }
    whole(edits.new_springs.size());
    for (const NewSpring& spring : edits.new_springs) {
      whole(spring.a), whole(spring.b);
      material(spring.material);
      raw(spring.rest_length.value());
      whole((spring.stiffness_factor != 1 ? 1u : 0u) | (spring.like ? 2u : 0u));
      if (spring.stiffness_factor != 1) raw(spring.stiffness_factor);
      if (spring.like) whole(*spring.like);
    }
    causes_and_scaling(change);
  }

 private:
  /// First writes bits: one for each kind of edit, which says whether any has a cause, and the two other bits. Then
  /// writes the causes and the scaling.
  void causes_and_scaling(const Change& change) {
    const Edits& edits = change.edits;
    std::uint32_t given = (edits.scaling ? scaling_bit : 0) | (change.lengths_given ? lengths_given_bit : 0);
    for (std::size_t i = 0; i < edit_kinds.size(); ++i)
      for_each_cause(edits, edit_kinds[i], [&](double cause) { given |= std::isnan(cause) ? 0 : 1u << i; });
    whole(given);
    for (std::size_t i = 0; i < edit_kinds.size(); ++i)
      if ((given >> i & 1) != 0)
        for_each_cause(edits, edit_kinds[i], [&](double cause) { raw(static_cast<float>(cause)); });
    if (!edits.scaling) return;
    whole(edits.scaling->number);
    raw(edits.scaling->from), raw(edits.scaling->to), raw(edits.scaling->whole);
  }

  void whole(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) bytes_.push_back(static_cast<char>(value | 0x80));
    bytes_.push_back(static_cast<char>(value));
  }

  template <class T>
  void raw(const T& value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }

  void ascending_indices(const std::vector<Removal>& removals) {
    whole(removals.size());
    std::uint32_t before = 0;
    for (const Removal& removal : removals) whole(removal.index - before), before = removal.index;
  }

  void changed(const ChangedSpring& spring) {
    whole(spring.spring);
    whole((spring.rest_length ? 1u : 0u) | (spring.material ? 2u : 0u) | (spring.stiffness_factor ? 4u : 0u));
    if (spring.rest_length) raw(*spring.rest_length);
    if (spring.material) material(*spring.material);
    if (spring.stiffness_factor) raw(*spring.stiffness_factor);
  }

  /// Writes the number of a material; at its first occurrence, also the material itself.
  void material(const Material& material) {
    const auto [found, is_new] = materials_.try_emplace(material, static_cast<std::uint32_t>(materials_.size()));
    whole(found->second);
    if (is_new) raw(material);
  }

  std::string& bytes_;
  MaterialNumbers& materials_;
};

/// Reads changes that a Writer has written.
class Reader {
 public:
  explicit Reader(const std::string& bytes) : bytes_(bytes) {}

  /// The materials read so far, by their numbers.
  const std::vector<Material>& materials() const { return materials_; }

  bool at_end() const { return at_ == bytes_.size(); }

  Change read() {
    Change change;
    Edits& edits = change.edits;
    change.cycle = index();
    if (const std::uint32_t op = index(); op > 0) change.op = op - 1;
    edits.removed_masses = ascending_indices();
    edits.removed_springs = ascending_indices();
    for (std::uint32_t left = index(); left > 0; --left) edits.changed_springs.push_back(changed());
    for (std::uint32_t left = index(); left > 0; --left) {
      NewMass& mass = edits.new_masses.emplace_back();
      mass.position = raw<Vec3>();
      mass.mass = raw<double>();
      const std::uint32_t material = index();
      if (material > std::numeric_limits<std::int32_t>::max()) fail();
      mass.material = static_cast<std::int32_t>(material) + no_material;
      if (const std::uint32_t mother = index(); mother > 0) mass.mother = mother - 1;
      mass.identity = raw<std::uint64_t>();
    }
    for (std::uint32_t left = index(); left > 0; --left) {
      NewSpring& spring = edits.new_springs.emplace_back();
      spring.a = index(), spring.b = index();
      spring.material = material();
      spring.rest_length = raw<double>();
      const std::uint32_t parts = index();
      if ((parts & 1) != 0) spring.stiffness_factor = raw<double>();
      if ((parts & 2) != 0) spring.like = index();
    }
    read_causes_and_scaling(change);
    return change;
  }

 private:
  [[noreturn]] static void fail() { throw std::invalid_argument("the record of a life is damaged"); }

  std::uint32_t index() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 35; shift += 7) {
      const auto byte = raw<std::uint8_t>();
      value |= static_cast<std::uint64_t>(byte & 0x7f) << shift;
      if (byte < 0x80) return value > 0xffffffff ? (fail(), 0) : static_cast<std::uint32_t>(value);
    }
    fail();
  }

  template <class T>
  T raw() {
    if (bytes_.size() - at_ < sizeof(T)) fail();
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }

  std::vector<Removal> ascending_indices() {
    std::vector<Removal> removals;
    for (std::uint32_t left = index(); left > 0; --left) {
      const std::uint64_t more = index(), before = removals.empty() ? 0 : removals.back().index;
      if (before + more > std::numeric_limits<std::uint32_t>::max() || (!removals.empty() && more == 0)) fail();
      removals.push_back({static_cast<std::uint32_t>(before + more)});
    }
    return removals;
  }

  void read_causes_and_scaling(Change& change) {
    Edits& edits = change.edits;
    const std::uint32_t given = index();
    change.lengths_given = (given & lengths_given_bit) != 0;
    for (std::size_t i = 0; i < edit_kinds.size(); ++i)
      if ((given >> i & 1) != 0)
        for_each_cause(edits, edit_kinds[i], [&](double& cause) { cause = static_cast<double>(raw<float>()); });
    if ((given & scaling_bit) == 0) return;
    Scaling& scaling = edits.scaling.emplace(Scaling{.number = index()});
    scaling.from = raw<double>(), scaling.to = raw<double>(), scaling.whole = raw<double>();
  }

  ChangedSpring changed() {
    ChangedSpring spring{.spring = index()};
    const std::uint32_t parts = index();
    if ((parts & 1) != 0) spring.rest_length = raw<double>();
    if ((parts & 2) != 0) spring.material = material();
    if ((parts & 4) != 0) spring.stiffness_factor = raw<double>();
    return spring;
  }

  Material material() {
    const std::uint32_t number = index();
    if (number > materials_.size()) fail();
    if (number == materials_.size()) materials_.push_back(raw<Material>());
    return materials_[number];
  }

  const std::string& bytes_;
  std::vector<Material> materials_;
  std::size_t at_ = 0;
};

}  // namespace

Change change_by(const Edits& edits, std::optional<std::uint32_t> op, const DevoContext& context) {
  const auto has_length = [](const NewSpring& spring) { return spring.rest_length.has_value(); };
  return {.cycle = static_cast<std::uint32_t>(context.cycle),
          .op = op,
          .edits = resolved(edits, context),
          .lengths_given = std::any_of(edits.new_springs.begin(), edits.new_springs.end(), has_length)};
}

bool has_causes(const Edits& edits) {
  bool found = false;
  for (const EditKind kind : edit_kinds)
    for_each_cause(edits, kind, [&](double cause) { found = found || !std::isnan(cause); });
  return found;
}

LifeRecord::LifeRecord(std::string bytes) : bytes_(std::move(bytes)) {
  Reader reader(bytes_);
  while (!reader.at_end()) reader.read();
  materials_ = numbered(reader.materials());
}

void LifeRecord::add(const Change& change) { Writer(bytes_, materials_).write(change); }

std::vector<Change> LifeRecord::changes() const {
  std::vector<Change> changes;
  for (Reader reader(bytes_); !reader.at_end();) changes.push_back(reader.read());
  return changes;
}

namespace {

std::vector<std::uint64_t> indices(std::size_t count) {
  std::vector<std::uint64_t> indices(count);
  std::iota(indices.begin(), indices.end(), std::uint64_t{0});
  return indices;
}

}  // namespace

MassNumbers::MassNumbers(std::size_t born) : MassNumbers(indices(born)) {}

MassNumbers::MassNumbers(std::vector<std::uint64_t> identities)
    : numbers_(identities.size()),
      daughters_(identities.size()),
      identities_(std::move(identities)),
      next_(static_cast<std::uint32_t>(numbers_.size())) {
  std::iota(numbers_.begin(), numbers_.end(), 0u);
}

std::uint32_t MassNumbers::add(const NewMass& mass) {
  if (mass.mother) ++daughters_.at(*mass.mother);
  daughters_.push_back(0);
  identities_.push_back(mass.identity.value());
  return numbers_.emplace_back(next_++);
}

void MassNumbers::remove(const std::vector<Removal>& masses) {
  for (auto mass = masses.rbegin(); mass != masses.rend(); ++mass) {
    numbers_.erase(numbers_.begin() + mass->index);
    daughters_.erase(daughters_.begin() + mass->index);
    identities_.erase(identities_.begin() + mass->index);
  }
}

void MassNumbers::apply(const Edits& edits) {
  for (const NewMass& mass : edits.new_masses) add(mass);
  remove(edits.removed_masses);
}

void derive_identities(std::vector<NewMass>& masses, const DevoContext& context) {
  std::map<std::uint32_t, std::uint64_t> borne;  // daughters by these edits, by mother
  std::uint64_t newcomers = 0;
  for (NewMass& mass : masses) {
    const bool has_mother = mass.mother && *mass.mother < context.body.masses.size();
    const std::uint64_t before =
        !has_mother ? newcomers++
                    : borne[*mass.mother]++ + (context.daughters.empty() ? 0 : context.daughters[*mass.mother]);
    if (!mass.identity)
      mass.identity = mixed(has_mother ? context.identity(*mass.mother) : context.draws.origin(), before);
  }
}

}  // namespace evodevo
