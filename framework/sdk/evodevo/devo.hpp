// Devo operators: they change a body after each cycle of its development.
#pragma once

#include <algorithm>
#include <array>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "evodevo/encoding.hpp"
#include "evodevo/genome.hpp"
#include "evodevo/operator.hpp"

namespace evodevo {

/// The records of the last cycle that a devo operator needs. The host makes no other records.
struct RecordRequest {
  // ---- one number for every spring ----
  bool stress = false;       ///< whether DevoContext::stress is needed
  bool peak_force = false;   ///< whether DevoContext::peak_force is needed
  bool muscle_work = false;  ///< whether DevoContext::muscle_work is needed
  bool tension = false;      ///< whether DevoContext::tension is needed
  // ---- one number for every mass ----
  bool contact = false;  ///< whether DevoContext::contact is needed
  bool age = false;      ///< whether DevoContext::age is needed
  bool degree = false;   ///< whether DevoContext::degree is needed
  bool load = false;     ///< whether DevoContext::load is needed
};

/// A record of the last cycle: one number for every spring, or for every mass. Reading it throws a std::logic_error
/// that names it unless Devo::observes() asks for it; an index out of range throws a std::out_of_range.
class RequestedRecord {
 public:
  /// `name` is that of the member of RecordRequest, and `of` what the numbers belong to, "spring" or "mass".
  explicit constexpr RequestedRecord(const char* name, const char* of = "spring") : name_(name), of_(of) {}
  /// Makes the record readable. For the host.
  void show(std::span<const double> values) { values_ = values; }

  std::size_t size() const { return values().size(); }
  auto begin() const { return values().begin(); }
  auto end() const { return values().end(); }
  double operator[](std::size_t index) const {
    if (index >= size())
      throw std::out_of_range(std::string("reads the record \"") + name_ + "\" of " + of_ + " " +
                              std::to_string(index) + " of " + std::to_string(size()) + ", numbered from 0");
    return values()[index];
  }
  operator std::span<const double>() const { return values(); }  // NOLINT: converts on purpose

 private:
  std::span<const double> values() const {
    if (!values_)
      throw std::logic_error(std::string("reads the record \"") + name_ + "\" of each " + of_ +
                             ", which observes() does not ask for; set RecordRequest::" + name_);
    return *values_;
  }

  const char* name_;
  const char* of_;
  std::optional<std::span<const double>> values_ = std::nullopt;
};

/// Values that a devo operator remembers about one item.
class RememberedValues {
 public:
  RememberedValues() = default;
  /// `of` says what the item is: "mass", "spring" or "body".
  RememberedValues(std::span<const double> values, const char* of) : values_(values), of_(of) {}

  /// Returns a value, in the order of the declared names. Throws std::out_of_range if there is no such value.
  double operator[](std::size_t number) const {
    if (number >= values_.size())
      throw std::out_of_range("reads value " + std::to_string(number) + " of " + std::to_string(values_.size()) +
                              " that it remembers about " + (std::string_view(of_) == "body" ? "the " : "each ") + of_ +
                              ", numbered from 0; declare it in Devo::" + of_ + "_memory()");
    return values_[number];
  }
  operator std::span<const double>() const { return values_; }  // NOLINT: converts on purpose

 private:
  std::span<const double> values_;
  const char* of_ = "item";
};

/// What a devo operator remembers about masses or springs: the same number of values for each. An operator declares
/// them in Devo::mass_memory() and Devo::spring_memory().
class Memory {
 public:
  Memory() = default;
  /// `values` has `width` values for each item, one item after the other. `of` says what an item is, "mass" or
  /// "spring".
  Memory(std::span<const double> values, std::size_t width, const char* of) : values_(values), width_(width), of_(of) {}

  /// Returns the values of one item. Throws std::out_of_range if there is no such item, or if nothing is remembered.
  RememberedValues operator[](std::size_t item) const {
    if (width_ == 0)
      throw std::out_of_range(std::string("reads what it remembers about each ") + of_ + ", but Devo::" + of_ +
                              "_memory() declares nothing");
    if (item >= size())
      throw std::out_of_range(std::string("reads what it remembers about ") + of_ + " " + std::to_string(item) +
                              " of " + std::to_string(size()) + ", numbered from 0");
    return {values_.subspan(item * width_, width_), of_};
  }
  std::size_t size() const { return width_ > 0 ? values_.size() / width_ : 0; }  ///< number of items
  std::size_t width() const { return width_; }                                   ///< number of values for each item

 private:
  std::span<const double> values_;
  std::size_t width_ = 0;
  const char* of_ = "item";
};

/// What a random number is for: a name, and a number if there are several of the same name.
struct Tag {
  constexpr Tag(const char* name, std::uint64_t number = 0)  // NOLINT: converts on purpose
      : Tag(std::string_view(name), number) {}
  constexpr Tag(std::string_view name, std::uint64_t number) {
    for (const char c : name) key = (key ^ static_cast<unsigned char>(c)) * 0x100000001b3;
    key = mixed(key, number);
  }
  std::uint64_t key = 0;
};

/// The random numbers of one application of one operator to one body. Each is a function of the key of the application,
/// of its tag and of the identities that it is drawn for, and of nothing else: not of other numbers that were drawn.
///
/// With inherited draws, the key consists of the seed of development, the label of the operator and the cycle; with
/// [development] draws_between_lives = "new" also of the number of the life; without inherited draws also of the
/// individual. Key by tag by identities -> the seed of a stream of Philox (Salmon et al. 2011).
class Draws {
 public:
  /// Makes draws that nobody can use, for contexts without random numbers.
  Draws() = default;
  /// `origin` stands for the operator and the cycle alone; the identities of newcomers follow from it.
  Draws(Rng::Philox philox, std::uint64_t key, std::uint64_t origin, bool inherited)
      : philox_(philox), key_(key), origin_(origin), inherited_(inherited) {}

  /// Whether relatives share the numbers.
  bool inherited() const { return inherited_; }
  std::uint64_t origin() const { return origin_; }

  /// Returns the stream of random numbers for a tag and identities, in this order. Throws std::logic_error if the
  /// context has no random numbers.
  Rng stream(const Tag& tag, std::initializer_list<std::uint64_t> identities = {}) const {
    if (philox_ == nullptr) throw std::logic_error("draws from a context that has no random numbers");
    std::uint64_t seed = mixed(key_, tag.key);
    for (const std::uint64_t identity : identities) seed = mixed(seed, identity);
    return Rng(philox_, {seed, 0, 0, 0});
  }

  /// Returns the first number of that stream, uniformly distributed in [0, 1).
  double number(const Tag& tag, std::initializer_list<std::uint64_t> identities = {}) const {
    return stream(tag, identities).uniform();
  }

 private:
  Rng::Philox philox_ = nullptr;
  std::uint64_t key_ = 0, origin_ = 0;
  bool inherited_ = false;
};

/// The context of a devo operator: everything that the operator may look at after a cycle.
///
/// `stress`, `peak_force`, `muscle_work` and `tension` are the records of the last cycle, with one number for every
/// spring of `body`; `contact`, `age`, `degree` and `load` have one number for every mass. Only those that
/// Devo::observes() asks for can be read. For a spring that another operator has added since the cycle ended, the
/// record is the mean of the records of the other springs; for such a mass, it is 0.
struct DevoContext {
  const Body& body;
  const State& state;
  int cycle;         ///< number of cycles simulated so far, from 1
  int cycles;        ///< number of cycles in the whole development
  int application;   ///< number of applications of this operator so far, including this one
  int applications;  ///< number of applications of this operator in the whole development
  double time;       ///< simulated time since birth, s
  Box bounds;   ///< bounding box of all position(), cut off at the floor if the scene has one, m; no new mass may lie
                ///< below it
  double mass;  ///< mass that a new point mass should have, kg
  bool resets;  ///< whether the body returns to its rest positions before the next cycle
  const Genome& genome;          ///< genes of the encoding
  const Layout& layout;          ///< layout of `genome`
  const Genome& own = no_genes;  ///< genes that the operator owns; see Devo::layout()
  /// Mean absolute force of each spring, N. If the experiment's probe is skip-shift, points instead: +1 for each tally
  /// in which the spring was the most stressed of its group, -1 for each in which it was the least stressed.
  RequestedRecord stress{"stress"};
  RequestedRecord peak_force{"peak_force"};    ///< largest absolute force of each spring, N
  RequestedRecord muscle_work{"muscle_work"};  ///< positive work that each spring's muscle did on the body, J
  RequestedRecord tension{"tension"};  ///< mean force of each spring, N; positive: it pulled, negative: it pushed
  RequestedRecord contact{"contact", "mass"};  ///< share of the last cycle in which each mass touched the ground, 1
  RequestedRecord age{"age", "mass"};          ///< number of cycles that each mass has lived through, cycles
  RequestedRecord degree{"degree", "mass"};    ///< number of springs at each mass when the cycle ended, 1
  RequestedRecord load{"load", "mass"};        ///< sum of the stress of the springs at each mass, in the unit of stress
  Memory mass_memory = {};    ///< what this operator remembers about each mass of `body`; see Devo::mass_memory()
  Memory spring_memory = {};  ///< what this operator remembers about each spring of `body`
  RememberedValues body_memory = {};  ///< what this operator remembers about the body as a whole
  double first_time = 0;              ///< simulated time from birth to the first application of this operator, s
  double last_time = 0;               ///< simulated time from birth to its last application, s
  std::span<const std::uint64_t> identities = {};  ///< of the masses of `body`; see identity()
  std::span<const std::uint32_t> daughters = {};   ///< number of daughters that each mass has had; see NewMass::mother
  Draws draws = {};                                ///< random numbers of this application; see draw()
  std::string_view scenario = {};  ///< name of the scenario of this life; empty: the experiment's own scene
  std::uint32_t life = 1;          ///< number of this life of the individual, from 1

  /// Returns the identity of a mass, which is the same in all individuals that have inherited the mass: that which the
  /// encoding gave it, or its index in the blueprint. That of a daughter follows from her mother's and from how many
  /// daughters her mother had before; that of another mass that came later, from the operator that added it, the cycle,
  /// and its place among the masses that were added together.
  std::uint64_t identity(std::uint32_t mass_index) const {
    return identities.empty() ? mass_index : identities[mass_index];
  }

  /// Returns a random number, uniformly distributed in [0, 1), that depends on its tag, on the operator and the cycle,
  /// and on the identities of the masses that it is drawn for, of none, one or two in either order. A second call
  /// returns the same number. With `[development] draws = "inherited"` it is the same in all individuals, and in all
  /// their lives unless `draws_between_lives` is "new"; otherwise each has its own. Throws std::logic_error if the
  /// context has no random numbers.
  double draw(const Tag& tag) const { return draws.number(tag); }
  double draw(std::uint32_t mass_index, const Tag& tag) const { return draws.number(tag, {identity(mass_index)}); }
  double draw(std::uint32_t a, std::uint32_t b, const Tag& tag) const {
    const auto [low, high] = std::minmax({identity(a), identity(b)});
    return draws.number(tag, {low, high});
  }

  /// Returns the number by which ties between masses are broken, smallest first: with inherited draws the identity,
  /// otherwise the index.
  std::uint64_t rank(std::uint32_t mass_index) const { return draws.inherited() ? identity(mass_index) : mass_index; }

  /// Returns the position from which a mass continues, m: its rest position if `resets`, else its present position.
  Vec3 position(std::uint32_t mass_index) const {
    return resets ? body.masses[mass_index].rest : state.position[mass_index];
  }
};

/// Stands for an edit without a cause.
inline constexpr double no_cause = std::numeric_limits<double>::quiet_NaN();

/// The kinds of edits of masses and springs.
enum class EditKind : std::uint8_t { removed_spring, removed_mass, changed_spring, new_mass, new_spring };
inline constexpr std::array edit_kinds{EditKind::removed_spring, EditKind::removed_mass, EditKind::changed_spring,
                                       EditKind::new_mass, EditKind::new_spring};

/// The removal of a mass or a spring.
struct Removal {
  std::uint32_t index = 0;
  double cause = no_cause;
};

/// A new mass. Its velocity is zero at first.
struct NewMass {
  Vec3 position = {};                          ///< m
  std::optional<double> mass = {};             ///< kg; if not given, DevoContext::mass
  std::int32_t material = no_material;         ///< index into DevoContext::body.materials, or no_material
  std::optional<std::uint32_t> mother = {};    ///< index of the mass from which it descends; none: it is a newcomer
  std::optional<std::uint64_t> identity = {};  ///< see DevoContext::identity(); if not given, the host derives it
  double cause = no_cause;
};

struct NewSpring {
  std::uint32_t a = 0, b = 0;  ///< indices of the two masses; see Edits
  Material material = {};
  std::optional<double> rest_length = {};  ///< m; if not given, the length at which the new spring exerts no force
  double stiffness_factor = 1;             ///< stiffness relative to that of the material, 1
  /// The spring of the body whose nature it takes over: all operators remember about the new spring what they remember
  /// about this one. If none is given, they remember 0.
  std::optional<std::uint32_t> like = {};
  double cause = no_cause;
};

/// New properties of an existing spring, which continues to join the same two masses.
struct ChangedSpring {
  std::uint32_t spring = 0;                     ///< index of the spring
  std::optional<double> rest_length = {};       ///< new rest length, m; if not given, it stays the same
  std::optional<Material> material = {};        ///< new material; if not given, it stays the same
  std::optional<double> stiffness_factor = {};  ///< new stiffness relative to that of the material, 1; likewise
  double cause = no_cause;
};

/// One step of a change of all rest lengths by one rule. In the whole change, the rest length of a spring goes linearly
/// from L to (1 + x) L, where x is a number that the operator remembers about the spring. The host multiplies the
/// present rest length by the ratio of the lengths after and before this step, so that other changes of the rest length
/// are preserved.
struct Scaling {
  std::uint32_t number = 0;  ///< which of the numbers in Devo::spring_memory() is x, 1; it must be above -1
  double from = 0, to = 0;   ///< progress of the change before and after this step, 0 to `whole`
  double whole = 1;          ///< progress at which the change is complete, for example the number of applications
};

/// What an operator remembers from now on about some items, or about the body.
struct MemoryEdits {
  std::vector<std::uint32_t> items;  ///< indices
  std::vector<std::size_t> counts;   ///< [items] number of values
  std::vector<double> values;        ///< those of each item, one item after the other

  void set(std::uint32_t item, std::span<const double> of_item) {
    items.push_back(item);
    counts.push_back(of_item.size());
    values.insert(values.end(), of_item.begin(), of_item.end());
  }
};

/// The changes that a devo operator requests. Indices of masses and springs refer to DevoContext::body. A new mass or
/// spring has the next index after those of the body and those added before it; so a new spring can join a new mass.
/// The host applies an operator's edits together after the call. The host refuses dangling springs, duplicate springs,
/// springs of air, and numbers that are not finite, with a message that names the operator, the cycle and the item.
///
/// Every edit may have a cause: the number that caused it, for example the stress of a spring that is removed. The host
/// stores causes in the record of the life; they have no effect on the body. Devo::measure() gives their name and unit.
class Edits {
 public:
  Edits() = default;
  /// Edits of a body with this many masses and springs.
  Edits(std::size_t masses, std::size_t springs)
      : masses_(static_cast<std::uint32_t>(masses)), springs_(static_cast<std::uint32_t>(springs)) {}
  explicit Edits(const Body& body) : Edits(body.masses.size(), body.springs.size()) {}

  /// Removes a spring; for example remove_spring(s, {.cause = context.stress[s]}). It may be removed more than once.
  void remove_spring(std::uint32_t spring, Removal removal = {}) {
    removal.index = spring;
    removed_springs.push_back(removal);
  }
  /// Removes a mass and its springs. It may be removed more than once.
  void remove_mass(std::uint32_t mass, Removal removal = {}) {
    removal.index = mass;
    removed_masses.push_back(removal);
  }
  /// Changes a spring that is not removed, once; for example change_spring(s, {.rest_length = 0.5}).
  void change_spring(std::uint32_t spring, ChangedSpring change) {
    change.spring = spring;
    changed_springs.push_back(change);
  }
  /// Joins two masses by a new spring, and returns its index; for example join(a, b, body.materials[0]).
  std::uint32_t join(std::uint32_t a, std::uint32_t b, const Material& material, NewSpring spring = {}) {
    spring.a = a, spring.b = b;
    spring.material = material;
    new_springs.push_back(spring);
    return springs_ + static_cast<std::uint32_t>(new_springs.size()) - 1;
  }
  template <class Number>
  requires std::is_arithmetic_v<Number> std::uint32_t join(std::uint32_t, std::uint32_t, Number, NewSpring = {})
  = delete;  // an index is no material: give body.materials[index]
  /// Adds a mass at a position (m), and returns its index.
  std::uint32_t add_mass(const Vec3& position, NewMass mass = {}) {
    mass.position = position;
    new_masses.push_back(mass);
    return masses_ + static_cast<std::uint32_t>(new_masses.size()) - 1;
  }
  /// Does the same; the new mass descends from another one, so that its identity follows from that of its mother.
  std::uint32_t divide(std::uint32_t mother, const Vec3& position, NewMass daughter = {}) {
    daughter.mother = mother;
    return add_mass(position, daughter);
  }
  /// Changes the rest lengths of all springs by one rule; a rest length that change_spring() gives overrides it.
  void scale_lengths(const Scaling& by) { scaling = by; }

  /// Sets what the operator remembers about a mass or a spring of the body, or about a new one: a value for each name
  /// of Devo::mass_memory() or Devo::spring_memory(). For other items of the body, it stays the same; for new items, it
  /// is 0 or that of NewSpring::like.
  void remember_mass(std::uint32_t mass, std::span<const double> values) { mass_memory.set(mass, values); }
  void remember_mass(std::uint32_t mass, std::initializer_list<double> values) {
    mass_memory.set(mass, {values.begin(), values.size()});
  }
  void remember_spring(std::uint32_t spring, std::span<const double> values) { spring_memory.set(spring, values); }
  void remember_spring(std::uint32_t spring, std::initializer_list<double> values) {
    spring_memory.set(spring, {values.begin(), values.size()});
  }
  /// Sets what the operator remembers about the body: a value for each name of Devo::body_memory().
  void remember_body(std::vector<double> values) { body_memory = std::move(values); }

  /// Gives the body up: its evaluation ends as `invalid`, for this reason.
  void give_up(std::string why) { failure = std::move(why); }

  /// Whether the body stays as it is.
  bool empty() const {
    return !scaling && removed_springs.empty() && removed_masses.empty() && changed_springs.empty() &&
           new_masses.empty() && new_springs.empty();
  }

  // what these functions have collected, for the host
  std::vector<Removal> removed_springs, removed_masses;
  std::vector<ChangedSpring> changed_springs;
  std::vector<NewMass> new_masses;
  std::vector<NewSpring> new_springs;
  std::optional<Scaling> scaling;
  MemoryEdits mass_memory, spring_memory;
  std::optional<std::vector<double>> body_memory;
  std::optional<std::string> failure;  ///< why the body was given up, if it was

 private:
  std::uint32_t masses_ = 0, springs_ = 0;  ///< of the body
};

/// Number of random pairs of masses to try for each new spring before giving up because too many pairs are joined
/// already.
inline constexpr std::size_t attempts_per_spring = 100;

/// The name and unit of a quantity ("1" is the unit of a dimensionless quantity).
struct Measure {
  std::string name, unit;
};

class Devo : public Operator {
 public:
  static constexpr std::string_view kind = "devo";

  /// Returns the records that develop() needs. The host calls this function after it has set the parameters.
  virtual RecordRequest observes() const { return {.stress = true}; }
  /// Returns the name and unit of the causes of a kind of edit. If the probe is skip-shift, the host reports points,
  /// not N.
  virtual Measure measure([[maybe_unused]] EditKind edit) const { return {"stress", "N"}; }
  /// Returns the names of the numbers that the operator remembers about each mass. The host keeps them from cycle to
  /// cycle and through all edits. At birth they are those that the encoding gives under the same names
  /// (Blueprint::mass_memory), otherwise 0. If the encoding must give them, Traits::needs_at_birth names them.
  virtual std::vector<std::string> mass_memory() const { return {}; }
  /// Likewise about each spring (Blueprint::spring_memory).
  virtual std::vector<std::string> spring_memory() const { return {}; }
  /// Likewise about the body as a whole; they are 0 at birth.
  virtual std::vector<std::string> body_memory() const { return {}; }
  /// Declares genes that the operator owns, so that the rule of development evolves together with the bodies.
  virtual Layout layout([[maybe_unused]] const EncodingContext& context) const { return {}; }
  /// Returns the genes that it owns for a first genome. `own` is the layout that it declares.
  virtual Genome random(const Layout& own, Rng& rng) const { return random_genome(own, rng); }
  /// Adds the wanted changes to `edits`, which is empty when this function is called.
  virtual void develop(const DevoContext& context, Edits& edits, Rng& rng) const = 0;
};

}  // namespace evodevo
