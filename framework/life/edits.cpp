#include "life/edits.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
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
      refuse("removes " + what + " " + std::to_string(index) + " of a body that has " + std::to_string(count));
    marks[index] = 1;
  }
  return marks;
}

std::uint64_t pair_key(std::uint32_t a, std::uint32_t b) {
  return static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b);
}

std::string pair_text(const NewSpring& spring) {
  return "joins masses " + std::to_string(spring.a) + " and " + std::to_string(spring.b);
}

/// One application of edits: the old body on one side, the new one growing on the other.
class Editor {
 public:
  Editor(LivingBody& living, const Edits& edits, const Moment& now)
      : living_(living),
        edits_(edits),
        now_(now),
        old_materials_(living.body.materials.size()),
        materials_(living.body.materials),
        spring_gone_(marked(edits.removed_springs, living.body.springs.size(), "spring")),
        mass_gone_(marked(edits.removed_masses, living.body.masses.size(), "mass")) {}

  void apply() {
    check_causes();
    if (edits_.growth) grow_springs(*edits_.growth);
    change_springs();
    const std::vector<NewSpring> arrivals = finished_springs();  // while the old indices hold
    move_masses();
    move_springs();
    refuse_joined_pairs(arrivals);
    for (const NewSpring& spring : arrivals) add_spring(spring);
    drop_unused_materials(living_.body);
  }

 private:
  std::size_t old_masses() const { return mass_gone_.size(); }

  /// Where a mass, old or new, is when life goes on.
  Vec3 place(std::uint32_t mass) const {
    return mass < old_masses() ? now_.place(mass) : edits_.new_masses[mass - old_masses()].place;
  }

  bool goes(const Spring& spring) const { return mass_gone_[spring.a] || mass_gone_[spring.b]; }

  void check_causes() const {
    const Causes& causes = edits_.causes;
    const auto check = [](std::size_t causes_given, std::size_t edits_made, const char* what) {
      if (causes_given != 0 && causes_given != edits_made)
        refuse("names " + std::to_string(causes_given) + " causes for " + std::to_string(edits_made) + " " + what);
    };
    check(causes.removed_springs.size(), edits_.removed_springs.size(), "removed springs");
    check(causes.removed_masses.size(), edits_.removed_masses.size(), "removed masses");
    check(causes.changed_springs.size(), edits_.changed_springs.size(), "changed springs");
    check(causes.new_masses.size(), edits_.new_masses.size(), "new masses");
    check(causes.new_springs.size(), edits_.new_springs.size(), "new springs");
  }

  static void check_material(const std::string& what, const Material& material) {
    if (is_air(material) || !std::isfinite(material.stiffness))
      refuse(what + " by a spring whose stiffness is " + to_text(material.stiffness) +
             "; expected a finite one above 0");
    if (!(material.amplitude >= 0 && material.amplitude < 1))
      refuse(what + " by a spring whose amplitude is " + to_text(material.amplitude) + "; expected 0 to below 1");
    if (!std::isfinite(material.frequency) || !std::isfinite(material.phase))
      refuse(what + " by a spring whose frequency or phase is not finite");
  }

  static bool is_rest_length(double length) { return length >= 0 && std::isfinite(length); }

  static void check_rest_length(const std::string& what, double length) {
    if (!is_rest_length(length))
      refuse(what + " by a spring whose rest length is " + to_text(length) + "; expected a finite one, at least 0");
  }

  static void check_growth(const Growth& growth) {
    // written so that NaN fails
    const auto on_the_way = [&](double gone) { return gone >= 0 && gone <= growth.whole; };
    if (!(growth.whole > 0) || !std::isfinite(growth.whole) || !on_the_way(growth.from) || !on_the_way(growth.to))
      refuse("grows springs from " + to_text(growth.from) + " to " + to_text(growth.to) + " of a way of " +
             to_text(growth.whole) + "; expected 0 to all of a finite one");
  }

  void grow_springs(const Growth& growth) {
    check_growth(growth);
    const auto relative_length = [&](const Spring& spring, double gone) {
      return 1 + (static_cast<double>(spring.growth) - 1) * gone / growth.whole;
    };
    for (Spring& spring : living_.body.springs) {
      spring.rest_length *= relative_length(spring, growth.to) / relative_length(spring, growth.from);
      if (!is_rest_length(spring.rest_length))
        refuse("grows a spring whose rest length then is " + to_text(spring.rest_length) +
               "; expected a finite one, at least 0");
    }
  }

  void change_springs() {
    Body& body = living_.body;
    std::vector<std::uint8_t> changed(body.springs.size(), 0);
    for (const ChangedSpring& change : edits_.changed_springs) {
      const std::string what = "replaces spring " + std::to_string(change.spring);
      if (change.spring >= body.springs.size())
        refuse(what + " of a body that has " + std::to_string(body.springs.size()));
      Spring& spring = body.springs[change.spring];
      if (spring_gone_[change.spring] || goes(spring)) refuse(what + ", which goes");
      if (std::exchange(changed[change.spring], 1)) refuse(what + " twice");
      if (change.material) check_material(what, *change.material);
      if (change.rest_length) check_rest_length(what, *change.rest_length);
      spring.rest_length = change.rest_length.value_or(spring.rest_length);
      if (change.material) spring.material = materials_.index(*change.material);
    }
  }

  void check_end(const NewSpring& spring, std::uint32_t end) const {
    if (end >= old_masses() + edits_.new_masses.size())
      refuse(pair_text(spring) + ", but there is no mass " + std::to_string(end));
    if (end < old_masses() && mass_gone_[end])
      refuse(pair_text(spring) + ", but mass " + std::to_string(end) + " goes");
  }

  /// The new springs, checked, each with its rest length.
  std::vector<NewSpring> finished_springs() const {
    std::vector<NewSpring> springs = edits_.new_springs;
    for (NewSpring& spring : springs) {
      check_end(spring, spring.a);
      check_end(spring, spring.b);
      if (spring.a == spring.b) refuse(pair_text(spring) + ", which are one");
      check_material(pair_text(spring), spring.material);
      if (!spring.rest_length) spring.rest_length = forceless_length(spring);
      check_rest_length(pair_text(spring), *spring.rest_length);
    }
    return springs;
  }

  double forceless_length(const NewSpring& spring) const {
    const double distance = norm(place(spring.a) - place(spring.b));
    return now_.resets ? distance : distance / spring.material.relative_length(now_.time);
  }

  void move_masses() {
    std::vector<Mass> masses;
    State state = living_.state;
    state.position.clear();
    state.velocity.clear();
    const auto add = [&](const Mass& mass, Vec3 position, Vec3 velocity) {
      new_index_.push_back(static_cast<std::uint32_t>(masses.size()));
      masses.push_back(mass);
      state.position.push_back(position);
      state.velocity.push_back(velocity);
    };
    for (std::size_t i = 0; i < old_masses(); ++i) {
      if (mass_gone_[i])
        new_index_.push_back(0);  // never looked up: springs to it go, and check_end refuses new ones
      else
        add(living_.body.masses[i], living_.state.position[i], living_.state.velocity[i]);
    }
    for (const NewMass& mass : edits_.new_masses) {
      if (!std::isfinite(norm(mass.place))) refuse("adds a mass at a place that is not finite");
      if (!(mass.mass > 0) || !std::isfinite(mass.mass))
        refuse("adds a mass whose weight is " + to_text(mass.mass) + "; expected a finite one above 0 kg");
      if (mass.material < no_material || mass.material >= static_cast<std::int64_t>(old_materials_))
        refuse("adds a mass of material " + std::to_string(mass.material) + " to a body that has " +
               std::to_string(old_materials_) + " materials");
      add({mass.place, mass.mass, mass.material, 0}, mass.place, {});
    }
    pass_load_on(masses);
    living_.body.masses = std::move(masses);
    living_.state = std::move(state);
  }

  /// Spreads the load of what goes evenly over those that carry one, or over all where nobody is left who does.
  void pass_load_on(std::vector<Mass>& masses) const {
    double load = 0;
    for (std::size_t i = 0; i < old_masses(); ++i)
      if (mass_gone_[i]) load += living_.body.masses[i].load;
    if (!(load > 0)) return;
    const auto carries = [](const Mass& mass) { return mass.load > 0; };
    const auto carriers = std::count_if(masses.begin(), masses.end(), carries);
    const double part =
        load / static_cast<double>(carriers > 0 ? carriers : static_cast<std::ptrdiff_t>(masses.size()));
    for (Mass& mass : masses) {
      if (carriers > 0 && !carries(mass)) continue;
      mass.load += part;
      mass.mass += part;
    }
  }

  void move_springs() {
    std::vector<Spring>& springs = living_.body.springs;
    std::vector<std::uint32_t> staying;
    staying.reserve(springs.size());
    for (std::uint32_t i = 0; i < springs.size(); ++i)
      if (!spring_gone_[i] && !goes(springs[i])) staying.push_back(i);
    for (const auto list : SpringRecords::lists)
      if ((living_.*list).size() == springs.size()) move_record(living_.*list, staying);
    for (std::size_t i = 0; i < staying.size(); ++i) {
      springs[i] = springs[staying[i]];
      springs[i].a = new_index_[springs[i].a];
      springs[i].b = new_index_[springs[i].b];
    }
    springs.resize(staying.size());
  }

  /// Leaves what stays in a record, and adds the mean of it for each spring that comes.
  void move_record(std::vector<double>& record, const std::vector<std::uint32_t>& staying) const {
    for (std::size_t i = 0; i < staying.size(); ++i) record[i] = record[staying[i]];
    record.resize(staying.size());
    const double sum = std::accumulate(record.begin(), record.end(), 0.0);
    record.resize(staying.size() + edits_.new_springs.size(),
                  staying.empty() ? 0 : sum / static_cast<double>(staying.size()));
  }

  std::uint64_t new_key(const NewSpring& spring) const { return pair_key(new_index_[spring.a], new_index_[spring.b]); }

  /// Few springs come and many are there: the few are sorted and the many looked up among them.
  void refuse_joined_pairs(const std::vector<NewSpring>& arrivals) const {
    std::vector<std::uint64_t> keys;
    for (const NewSpring& spring : arrivals) keys.push_back(new_key(spring));
    std::sort(keys.begin(), keys.end());
    const auto refuse_pair = [&](std::uint64_t key) {
      for (auto spring = arrivals.rbegin(); spring != arrivals.rend(); ++spring)
        if (new_key(*spring) == key) refuse(pair_text(*spring) + ", which are joined already");
    };
    if (const auto twin = std::adjacent_find(keys.begin(), keys.end()); twin != keys.end()) refuse_pair(*twin);
    // most springs are told apart from all arrivals by one of their ends
    std::vector<std::uint8_t> is_lower(living_.body.masses.size(), 0), is_upper = is_lower;
    for (const std::uint64_t key : keys) is_lower[key >> 32] = is_upper[key & 0xffffffff] = 1;
    for (const Spring& spring : living_.body.springs) {
      if (!is_lower[std::min(spring.a, spring.b)] || !is_upper[std::max(spring.a, spring.b)]) continue;
      if (const auto key = pair_key(spring.a, spring.b); std::binary_search(keys.begin(), keys.end(), key))
        refuse_pair(key);
    }
  }

  void add_spring(const NewSpring& spring) {
    living_.body.springs.push_back({new_index_[spring.a], new_index_[spring.b], *spring.rest_length,
                                    materials_.index(spring.material), 1, *spring.rest_length});
  }

  LivingBody& living_;
  const Edits& edits_;
  const Moment& now_;
  std::size_t old_materials_;  ///< how many there were before the edits
  MaterialList materials_;
  std::vector<std::uint8_t> spring_gone_, mass_gone_;
  std::vector<std::uint32_t> new_index_;  ///< of every old and new mass
};

}  // namespace

void apply_edits(LivingBody& living, const Edits& edits, const Moment& now) {
  if (!edits.empty()) Editor(living, edits, now).apply();
}

void show_records(const SpringRecords& records, const SpringRequest& request, Moment& now) {
  using Shown = std::span<const double>;
  now.stress = request.stress ? Shown(records.stress) : Shown();
  now.peak_force = request.peak_force ? Shown(records.peak_force) : Shown();
  now.muscle_work = request.muscle_work ? Shown(records.muscle_work) : Shown();
  now.tension = request.tension ? Shown(records.tension) : Shown();
}

}  // namespace evodevo
