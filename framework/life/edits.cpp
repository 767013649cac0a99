#include "life/edits.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "base/materials.hpp"
#include "base/text.hpp"

namespace evodevo {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument(what); }

/// Marks removed items among `count` items. `what` names the items in errors.
std::vector<std::uint8_t> marked(const std::vector<Removal>& removals, std::size_t count, const std::string& what) {
  std::vector<std::uint8_t> marks(count, 0);
  for (const auto& [index, cause] : removals) {
    if (index >= count)
      refuse("removes " + what + " " + std::to_string(index) + ", but the body has only " + std::to_string(count) +
             ", numbered from 0");
    marks[index] = 1;
  }
  return marks;
}

std::uint64_t pair_key(std::uint32_t a, std::uint32_t b) {
  return static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b);
}

/// The pairs of masses that new springs join. There are few new springs and many others; hence the new ones are sorted,
/// and each of the others is looked up among them.
class NewPairs {
 public:
  /// `keys`: of the pairs, ascending.
  NewPairs(std::vector<std::uint64_t> keys, std::size_t masses)
      : keys_(std::move(keys)), is_lower_(masses, 0), is_upper_(masses, 0) {
    for (const std::uint64_t key : keys_) is_lower_[key >> 32] = is_upper_[key & 0xffffffff] = 1;
  }

  bool contains(const Spring& spring) const {
    // for most springs, one of their ends shows that no new spring joins the same pair
    if (!is_lower_[std::min(spring.a, spring.b)] || !is_upper_[std::max(spring.a, spring.b)]) return false;
    return std::binary_search(keys_.begin(), keys_.end(), pair_key(spring.a, spring.b));
  }

 private:
  std::vector<std::uint64_t> keys_;
  std::vector<std::uint8_t> is_lower_, is_upper_;  ///< [masses] whether the mass is that end of a new spring
};

std::string pair_text(const NewSpring& spring) {
  return "joins masses " + std::to_string(spring.a) + " and " + std::to_string(spring.b);
}

/// Sorts removals by index and leaves the first of those of one item.
void put_in_order(std::vector<Removal>& removals) {
  std::ranges::stable_sort(removals, {}, &Removal::index);
  removals.erase(std::ranges::unique(removals, {}, &Removal::index).begin(), removals.end());
}

/// Returns the rest length (m) at which a new spring exerts no force at first; nullopt if one of its masses does not
/// exist.
std::optional<double> forceless_length(const NewSpring& spring, const Edits& edits, const DevoContext& context) {
  const std::size_t old_masses = context.body.masses.size();
  if (std::max(spring.a, spring.b) >= old_masses + edits.new_masses.size()) return std::nullopt;
  const auto position = [&](std::uint32_t mass) {
    return mass < old_masses ? context.position(mass) : edits.new_masses[mass - old_masses].position;
  };
  const double distance = norm(position(spring.a) - position(spring.b));
  return context.resets ? distance : distance / spring.material.relative_length(context.time);
}

bool is_rest_length(double length) { return length >= 0 && std::isfinite(length); }

void check_scaling(const Scaling& scaling, const ItemMemory& memory) {
  if (scaling.number >= memory.width)
    refuse("scales rest lengths by number " + std::to_string(scaling.number) +
           " that it remembers about springs, but spring_memory() declares only " + std::to_string(memory.width) +
           ", numbered from 0");
  // written so that NaN fails
  const auto on_the_way = [&](double gone) { return gone >= 0 && gone <= scaling.whole; };
  if (!(scaling.whole > 0) || !std::isfinite(scaling.whole) || !on_the_way(scaling.from) || !on_the_way(scaling.to))
    refuse("scales rest lengths from " + to_text(scaling.from) + " to " + to_text(scaling.to) + " of a whole of " +
           to_text(scaling.whole) + "; expected a finite whole above 0, and both numbers from 0 to it");
}

/// Returns the rest length (m) of a spring after a step of a scaling that check_scaling() accepts. Throws if it is
/// none.
double scaled_length(const Scaling& scaling, const Body& body, std::size_t spring, const ItemMemory& memory) {
  const double whole_change = memory.values[spring * memory.width + scaling.number];
  const auto relative_length = [&](double gone) { return 1 + whole_change * gone / scaling.whole; };
  const double length =
      body.springs[spring].rest_length * (relative_length(scaling.to) / relative_length(scaling.from));
  if (!is_rest_length(length))
    refuse("scales spring " + std::to_string(spring) + " to a rest length of " + to_text(length) +
           "; expected a finite value, at least 0");
  return length;
}

/// Applies edits to a body once.
class Editor {
 public:
  Editor(const Edits& edits, LivingBody& living, std::optional<std::uint32_t> op)
      : edits_(edits),
        body_(living.body),
        living_(living),
        op_(op),
        old_materials_(living.body.materials.size()),
        spring_gone_(marked(edits.removed_springs, living.body.springs.size(), "spring")),
        mass_gone_(marked(edits.removed_masses, living.body.masses.size(), "mass")) {}

  void apply() {
    if (edits_.scaling) scale_lengths(*edits_.scaling);
    if (only_scales(edits_)) return;  // as after every cycle in some lives
    change_springs();
    check_new_springs();  // before the indices of masses change
    move_masses();
    move_springs();
    for (const NewSpring& spring : edits_.new_springs) add_spring(spring);
    drop_unused_materials(body_);
  }

 private:
  std::size_t old_masses() const { return mass_gone_.size(); }

  /// The index of a material among those of the body, to which it is added if it is not there.
  std::uint32_t index_of(const Material& material) {
    return (materials_ ? *materials_ : materials_.emplace(body_.materials)).index(material);
  }

  bool goes(const Spring& spring) const { return mass_gone_[spring.a] || mass_gone_[spring.b]; }

  // `what` makes the beginning of a message, which most springs do not need
  static void check_material(const auto& what, const Material& material) {
    if (is_air(material) || !std::isfinite(material.stiffness))
      refuse(what() + " by a spring whose stiffness is " + to_text(material.stiffness) +
             "; expected a finite value above 0");
    if (!(material.amplitude >= 0 && material.amplitude <= largest_amplitude))
      refuse(what() + " by a spring whose amplitude is " + to_text(material.amplitude) + "; expected 0 to " +
             to_text(largest_amplitude));
    if (!std::isfinite(material.frequency) || !std::isfinite(material.phase))
      refuse(what() + " by a spring whose frequency or phase is not finite");
    if (!(material.damping >= 0) || !std::isfinite(material.damping))
      refuse(what() + " by a spring whose damping ratio is " + to_text(material.damping) +
             "; expected a finite value, at least 0");
  }

  static void check_rest_length(const auto& what, double length) {
    if (!is_rest_length(length))
      refuse(what() + " by a spring whose rest length is " + to_text(length) + "; expected a finite value, at least 0");
  }

  static void check_stiffness(const auto& what, const Material& material, double factor) {
    const double stiffness = factor * material.stiffness;
    if (!(stiffness > 0) || !std::isfinite(stiffness))
      refuse(what() + " by a spring with " + to_text(factor) + " times the stiffness of its material, " +
             to_text(material.stiffness) + " N/m; expected a finite stiffness above 0");
  }

  void scale_lengths(const Scaling& scaling) {
    static const ItemMemory nothing;
    const ItemMemory& memory = op_ && *op_ < living_.memory.size() ? living_.memory[*op_].springs : nothing;
    check_scaling(scaling, memory);
    for (std::size_t s = 0; s < body_.springs.size(); ++s)
      if (!spring_gone_[s] && !goes(body_.springs[s]))
        body_.springs[s].rest_length = scaled_length(scaling, body_, s, memory);
  }

  void change_springs() {
    if (edits_.changed_springs.empty()) return;
    std::vector<std::uint8_t> changed(body_.springs.size(), 0);
    for (const ChangedSpring& change : edits_.changed_springs) {
      const auto what = [&] { return "replaces spring " + std::to_string(change.spring); };
      if (change.spring >= body_.springs.size())
        refuse(what() + ", but the body has only " + std::to_string(body_.springs.size()) + ", numbered from 0");
      Spring& spring = body_.springs[change.spring];
      if (spring_gone_[change.spring] || goes(spring)) refuse(what() + ", which the same edits remove");
      if (std::exchange(changed[change.spring], 1)) refuse(what() + " twice");
      if (change.material) check_material(what, *change.material);
      if (change.rest_length) check_rest_length(what, *change.rest_length);
      spring.rest_length = change.rest_length.value_or(spring.rest_length);
      spring.stiffness_factor = change.stiffness_factor.value_or(spring.stiffness_factor);
      if (change.material) spring.material = index_of(*change.material);
      check_stiffness(what, body_.materials[spring.material], spring.stiffness_factor);
    }
  }

  void check_end(const NewSpring& spring, std::uint32_t end) const {
    if (end >= old_masses() + edits_.new_masses.size())
      refuse(pair_text(spring) + ", but there is no mass " + std::to_string(end));
    if (end < old_masses() && mass_gone_[end])
      refuse(pair_text(spring) + ", but mass " + std::to_string(end) + " is removed by the same edits");
  }

  void check_new_springs() const {
    for (const NewSpring& spring : edits_.new_springs) {
      for (const std::uint32_t end : {spring.a, spring.b}) check_end(spring, end);
      if (spring.a == spring.b) refuse(pair_text(spring) + ", which are the same mass");
      const auto what = [&] { return pair_text(spring); };
      check_material(what, spring.material);
      check_stiffness(what, spring.material, spring.stiffness_factor);
      check_rest_length(what, spring.rest_length.value());
      if (spring.like && *spring.like >= body_.springs.size())
        refuse(what() + " by one like spring " + std::to_string(*spring.like) + ", but the body has only " +
               std::to_string(body_.springs.size()) + ", numbered from 0");
    }
  }

  void move_masses() {
    if (edits_.removed_masses.empty() && edits_.new_masses.empty()) {
      new_index_.resize(old_masses());
      return std::iota(new_index_.begin(), new_index_.end(), 0u);
    }
    std::vector<Mass> masses;
    std::vector<Vec3> positions, velocities;
    std::vector<std::uint32_t> staying;
    const auto add = [&](const Mass& mass, Vec3 position, Vec3 velocity) {
      new_index_.push_back(static_cast<std::uint32_t>(masses.size()));
      masses.push_back(mass);
      positions.push_back(position);
      velocities.push_back(velocity);
    };
    for (std::size_t i = 0; i < old_masses(); ++i) {
      if (mass_gone_[i]) {
        new_index_.push_back(0);  // never used: springs to it are removed, and check_end() refuses new ones
        continue;
      }
      staying.push_back(static_cast<std::uint32_t>(i));
      add(body_.masses[i], living_.state.position[i], living_.state.velocity[i]);
    }
    for (std::size_t i = 0; i < edits_.new_masses.size(); ++i) {
      const NewMass& mass = edits_.new_masses[i];
      check_new_mass(mass, "adds mass " + std::to_string(old_masses() + i));
      add({mass.position, mass.mass.value(), mass.material, 0}, mass.position, {});
    }
    pass_payload_on(masses);
    body_.masses = std::move(masses);
    living_.state.position = std::move(positions);
    living_.state.velocity = std::move(velocities);
    move_numbers_of_masses(staying);
  }

  /// Lets everything that is known about masses follow the edits.
  void move_numbers_of_masses(const std::vector<std::uint32_t>& staying) const {
    const auto move = [&](std::vector<double>& list, std::size_t width) {
      follow(list, width, old_masses(), staying, edits_.new_masses.size());
    };
    const auto move_if_there = [&](std::vector<double>& list) {
      if (list.size() == old_masses()) move(list, 1);
    };
    for (const auto list : MassRecords::lists) move_if_there(living_.*list);
    move_if_there(living_.contact_times);
    move_if_there(living_.cycles_lived);
    for (OperatorMemory& memory : living_.memory) move(memory.masses.values, memory.masses.width);
  }

  void check_new_mass(const NewMass& mass, const std::string& what) const {
    if (!std::isfinite(norm(mass.position))) refuse(what + ", whose position is not finite");
    if (!(*mass.mass > 0) || !std::isfinite(*mass.mass))
      refuse(what + ", which weighs " + to_text(*mass.mass) + " kg; expected a finite value above 0 kg");
    if (mass.material < no_material || mass.material >= static_cast<std::int64_t>(old_materials_))
      refuse(what + " of material " + std::to_string(mass.material) + ", but the body has " +
             std::to_string(old_materials_) + " materials");
    if (mass.mother && *mass.mother >= old_masses())
      refuse(what + ", a daughter of mass " + std::to_string(*mass.mother) + ", which does not exist");
  }

  /// Spreads the payload of removed masses evenly over the masses that carry payload, or over all if none does.
  void pass_payload_on(std::vector<Mass>& masses) const {
    double payload = 0;
    for (std::size_t i = 0; i < old_masses(); ++i)
      if (mass_gone_[i]) payload += body_.masses[i].payload;
    if (!(payload > 0)) return;
    const auto carries = [](const Mass& mass) { return mass.payload > 0; };
    const auto carriers = std::count_if(masses.begin(), masses.end(), carries);
    const double part =
        payload / static_cast<double>(carriers > 0 ? carriers : static_cast<std::ptrdiff_t>(masses.size()));
    for (Mass& mass : masses) {
      if (carriers > 0 && !carries(mass)) continue;
      mass.payload += part;
      mass.mass += part;
    }
  }

  /// Removes the springs that go and lets the others follow their masses. Throws if a new spring joins the same pair of
  /// masses as one of them. All in one pass, because large bodies do not fit into a core's cache.
  void move_springs() {
    std::vector<Spring>& springs = body_.springs;
    const bool masses_go = !edits_.removed_masses.empty();
    const NewPairs new_pairs = pairs_of_new_springs();
    std::vector<std::uint32_t> staying;
    staying.reserve(springs.size());
    for (std::uint32_t i = 0; i < springs.size(); ++i) {
      if (spring_gone_[i] || (masses_go && goes(springs[i]))) continue;
      Spring& spring = springs[staying.size()] = springs[i];
      staying.push_back(i);
      if (masses_go) {  // otherwise, all masses keep their indices
        spring.a = new_index_[spring.a];
        spring.b = new_index_[spring.b];
      }
      if (new_pairs.contains(spring)) refuse_pair(pair_key(spring.a, spring.b));
    }
    springs.resize(staying.size());
    move_numbers_of_springs(staying);
  }

  /// Lets everything that is known about springs follow the edits.
  void move_numbers_of_springs(const std::vector<std::uint32_t>& staying) const {
    for (const auto list : SpringRecords::lists)
      if ((living_.*list).size() == spring_gone_.size()) move_record(living_.*list, staying);
    for (OperatorMemory& memory : living_.memory) {
      remember_new(edits_.new_springs, spring_gone_.size(), memory.springs);
      follow(memory.springs.values, memory.springs.width, spring_gone_.size(), staying, edits_.new_springs.size());
    }
  }

  /// Keeps the values of the springs that stay, and adds the mean of these values for each new spring.
  void move_record(std::vector<double>& record, const std::vector<std::uint32_t>& staying) const {
    double sum = 0;
    for (std::size_t i = 0; i < staying.size(); ++i) sum += record[i] = record[staying[i]];
    record.resize(staying.size());
    record.resize(staying.size() + edits_.new_springs.size(),
                  staying.empty() ? 0 : sum / static_cast<double>(staying.size()));
  }

  std::uint64_t new_key(const NewSpring& spring) const { return pair_key(new_index_[spring.a], new_index_[spring.b]); }

  /// The pairs of masses that new springs join. Throws if two of them are the same pair.
  NewPairs pairs_of_new_springs() const {
    std::vector<std::uint64_t> keys;
    for (const NewSpring& spring : edits_.new_springs) keys.push_back(new_key(spring));
    std::sort(keys.begin(), keys.end());
    if (const auto twin = std::adjacent_find(keys.begin(), keys.end()); twin != keys.end()) refuse_pair(*twin);
    return {std::move(keys), body_.masses.size()};
  }

  /// Says which new spring, the last of them, joins a pair that is joined already.
  [[noreturn]] void refuse_pair(std::uint64_t key) const {
    const auto joins_it = [&](const NewSpring& spring) { return new_key(spring) == key; };
    refuse(pair_text(*std::find_if(edits_.new_springs.rbegin(), edits_.new_springs.rend(), joins_it)) +
           ", which are joined already");
  }

  void add_spring(const NewSpring& spring) {
    body_.springs.push_back({new_index_[spring.a], new_index_[spring.b], *spring.rest_length, index_of(spring.material),
                             *spring.rest_length, spring.stiffness_factor});
  }

  const Edits& edits_;
  Body& body_;
  LivingBody& living_;
  std::optional<std::uint32_t> op_;
  std::size_t old_materials_;              ///< number of materials before the edits
  std::optional<MaterialList> materials_;  ///< of the body, once it is needed, because hashing many takes long
  std::vector<std::uint8_t> spring_gone_, mass_gone_;
  std::vector<std::uint32_t> new_index_;  ///< new index of every old and new mass
};

}  // namespace

Edits resolved(const Edits& edits, const DevoContext& context) {
  Edits result = edits;
  put_in_order(result.removed_masses);
  put_in_order(result.removed_springs);
  for (NewMass& mass : result.new_masses) mass.mass = mass.mass.value_or(context.mass);
  derive_identities(result.new_masses, context);
  for (NewSpring& spring : result.new_springs)
    if (!spring.rest_length) spring.rest_length = forceless_length(spring, edits, context);
  return result;
}

void write_out_scaling(Edits& edits, const Body& body, const ItemMemory& memory) {
  if (!edits.scaling) return;
  const Scaling scaling = *std::exchange(edits.scaling, std::nullopt);
  check_scaling(scaling, memory);
  const std::vector<std::uint8_t> spring_goes = marked(edits.removed_springs, body.springs.size(), "spring"),
                                  mass_goes = marked(edits.removed_masses, body.masses.size(), "mass");
  std::vector<std::optional<std::size_t>> change(body.springs.size());  // of each spring, among the edits
  for (std::size_t i = 0; i < edits.changed_springs.size(); ++i)
    if (const std::uint32_t spring = edits.changed_springs[i].spring; spring < change.size()) change[spring] = i;
  for (std::uint32_t s = 0; s < body.springs.size(); ++s) {
    const Spring& spring = body.springs[s];
    if (spring_goes[s] || mass_goes[spring.a] || mass_goes[spring.b]) continue;
    const double length = scaled_length(scaling, body, s, memory);
    if (length == spring.rest_length) continue;
    if (!change[s])
      edits.changed_springs.push_back({.spring = s, .rest_length = length});
    else if (std::optional<double>& given = edits.changed_springs[*change[s]].rest_length; !given)
      given = length;
  }
}

void apply(const Edits& resolved, LivingBody& living, std::optional<std::uint32_t> op) {
  if (resolved.empty()) return;
  const bool is_numbered = living.numbers.numbers().size() == living.body.masses.size();
  Editor(resolved, living, op).apply();
  if (is_numbered) living.numbers.apply(resolved);
  living.version = nullptr;
}

}  // namespace evodevo
