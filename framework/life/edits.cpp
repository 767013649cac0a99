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

/// Marks `indices` among `count` items. `what` names the items in errors.
std::vector<std::uint8_t> marked(const std::vector<std::uint32_t>& indices, std::size_t count,
                                 const std::string& what) {
  std::vector<std::uint8_t> marks(count, 0);
  for (const std::uint32_t index : indices) {
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

/// Sorts indices in ascending order and removes duplicates; each index keeps its cause.
void put_in_order(std::vector<std::uint32_t>& indices, std::vector<double>& causes) {
  const bool have_causes = !causes.empty();
  if (have_causes && causes.size() != indices.size()) return;
  std::vector<std::pair<std::uint32_t, double>> ordered;
  for (std::size_t i = 0; i < indices.size(); ++i) ordered.emplace_back(indices[i], have_causes ? causes[i] : 0);
  const auto index_of = [](const auto& item) { return item.first; };
  std::ranges::stable_sort(ordered, {}, index_of);
  ordered.erase(std::ranges::unique(ordered, {}, index_of).begin(), ordered.end());
  indices.clear();
  if (have_causes) causes.clear();
  for (const auto& [index, cause] : ordered) {
    indices.push_back(index);
    if (have_causes) causes.push_back(cause);
  }
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

/// Applies edits to a body once.
class Editor {
 public:
  /// `living` is the life of the body, or nullptr if the body stands alone.
  Editor(const Edits& edits, Body& body, LivingBody* living)
      : edits_(edits),
        body_(body),
        living_(living),
        old_materials_(body.materials.size()),
        spring_gone_(marked(edits.removed_springs, body.springs.size(), "spring")),
        mass_gone_(marked(edits.removed_masses, body.masses.size(), "mass")) {}

  void apply() {
    check_causes();
    if (edits_.growth) grow_springs(*edits_.growth);
    if (only_grows(edits_)) return;  // as after every cycle in some lives
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

  void check_causes() const {
    const Causes& causes = edits_.causes;
    const auto check = [](std::size_t causes_given, std::size_t edits_made, const char* what) {
      if (causes_given != 0 && causes_given != edits_made)
        refuse("gives " + std::to_string(causes_given) + " causes for " + std::to_string(edits_made) + " " + what +
               "; expected one for each, or none");
    };
    check(causes.removed_springs.size(), edits_.removed_springs.size(), "removed springs");
    check(causes.removed_masses.size(), edits_.removed_masses.size(), "removed masses");
    check(causes.changed_springs.size(), edits_.changed_springs.size(), "changed springs");
    check(causes.new_masses.size(), edits_.new_masses.size(), "new masses");
    check(causes.new_springs.size(), edits_.new_springs.size(), "new springs");
  }

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

  static bool is_rest_length(double length) { return length >= 0 && std::isfinite(length); }
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

  static void check_growth(const Growth& growth) {
    // written so that NaN fails
    const auto on_the_way = [&](double gone) { return gone >= 0 && gone <= growth.whole; };
    if (!(growth.whole > 0) || !std::isfinite(growth.whole) || !on_the_way(growth.from) || !on_the_way(growth.to))
      refuse("grows springs from " + to_text(growth.from) + " to " + to_text(growth.to) + " of a whole of " +
             to_text(growth.whole) + "; expected a finite whole above 0, and both numbers from 0 to it");
  }

  void grow_springs(const Growth& growth) {
    check_growth(growth);
    const auto relative_length = [&](const Spring& spring, double gone) {
      return 1 + (static_cast<double>(spring.growth) - 1) * gone / growth.whole;
    };
    for (Spring& spring : body_.springs) {
      spring.rest_length *= relative_length(spring, growth.to) / relative_length(spring, growth.from);
      if (!is_rest_length(spring.rest_length))
        refuse("grows a spring to a rest length of " + to_text(spring.rest_length) +
               "; expected a finite value, at least 0");
    }
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
      if (!std::isfinite(spring.phase_growth)) refuse(pair_text(spring) + " with a phase_growth that is not finite");
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
      add(body_.masses[i], living_ != nullptr ? living_->state.position[i] : Vec3{},
          living_ != nullptr ? living_->state.velocity[i] : Vec3{});
    }
    for (const NewMass& mass : edits_.new_masses) {
      check_new_mass(mass);
      add({mass.position, mass.mass, mass.material, 0}, mass.position, {});
    }
    pass_payload_on(masses);
    body_.masses = std::move(masses);
    if (living_ == nullptr) return;
    living_->state.position = std::move(positions);
    living_->state.velocity = std::move(velocities);
    move_numbers_of_masses(*living_, staying);
  }

  /// Lets everything that is known about masses follow the edits.
  void move_numbers_of_masses(LivingBody& living, const std::vector<std::uint32_t>& staying) const {
    const auto move = [&](std::vector<double>& list, std::size_t width) {
      follow(list, width, old_masses(), staying, edits_.new_masses.size());
    };
    const auto move_if_there = [&](std::vector<double>& list) {
      if (list.size() == old_masses()) move(list, 1);
    };
    for (const auto list : MassRecords::lists) move_if_there(living.*list);
    move_if_there(living.contact_times);
    move_if_there(living.cycles_lived);
    for (OperatorMemory& memory : living.memory) move(memory.masses.values, memory.masses.width);
  }

  void check_new_mass(const NewMass& mass) const {
    if (!std::isfinite(norm(mass.position))) refuse("adds a mass whose position is not finite");
    if (!(mass.mass > 0) || !std::isfinite(mass.mass))
      refuse("adds a mass that weighs " + to_text(mass.mass) + " kg; expected a finite value above 0 kg");
    if (mass.material < no_material || mass.material >= static_cast<std::int64_t>(old_materials_))
      refuse("adds a mass of material " + std::to_string(mass.material) + ", but the body has " +
             std::to_string(old_materials_) + " materials");
    if (mass.mother && *mass.mother >= old_masses())
      refuse("adds a daughter of mass " + std::to_string(*mass.mother) + ", which does not exist");
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
    if (living_ != nullptr) move_numbers_of_springs(*living_, staying);
  }

  /// Lets everything that is known about springs follow the edits.
  void move_numbers_of_springs(LivingBody& living, const std::vector<std::uint32_t>& staying) const {
    for (const auto list : SpringRecords::lists)
      if ((living.*list).size() == spring_gone_.size()) move_record(living.*list, staying);
    for (OperatorMemory& memory : living.memory)
      follow(memory.springs.values, memory.springs.width, spring_gone_.size(), staying, edits_.new_springs.size());
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
                             1, *spring.rest_length, spring.stiffness_factor, spring.phase_growth});
  }

  const Edits& edits_;
  Body& body_;
  LivingBody* living_;
  std::size_t old_materials_;              ///< number of materials before the edits
  std::optional<MaterialList> materials_;  ///< of the body, once it is needed, because hashing many takes long
  std::vector<std::uint8_t> spring_gone_, mass_gone_;
  std::vector<std::uint32_t> new_index_;  ///< new index of every old and new mass
};

}  // namespace

Edits resolved(const Edits& edits, const DevoContext& context) {
  Edits result = edits;
  put_in_order(result.removed_masses, result.causes.removed_masses);
  put_in_order(result.removed_springs, result.causes.removed_springs);
  derive_identities(result.new_masses, context);
  for (NewSpring& spring : result.new_springs)
    if (!spring.rest_length) spring.rest_length = forceless_length(spring, edits, context);
  return result;
}

void apply(const Edits& resolved, LivingBody& living) {
  if (resolved.empty()) return;
  const bool is_numbered = living.numbers.numbers().size() == living.body.masses.size();
  Editor(resolved, living.body, &living).apply();
  if (is_numbered) living.numbers.apply(resolved);
  living.version = nullptr;
}

void apply(const Edits& resolved, Body& body) {
  if (!resolved.empty()) Editor(resolved, body, nullptr).apply();
}

}  // namespace evodevo
