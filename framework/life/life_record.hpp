// A compact record of all changes that development makes to a body during its life.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/materials.hpp"
#include "evodevo/devo.hpp"

namespace evodevo {

/// Edits that were applied together after a cycle. All indices refer to the body before these edits.
struct Change {
  std::uint32_t cycle = 0;          ///< cycle, from 1
  std::optional<std::uint32_t> op;  ///< index into the experiment's devo operators; none: removal of torn-off pieces
  Edits edits;                      ///< edits as resolved() returns them
  bool lengths_given = false;       ///< whether the operator itself set the rest length of a new spring
};

/// Returns the change that consists of the `edits` of operator `op`, which are still to be applied.
Change change_by(const Edits& edits, std::optional<std::uint32_t> op, const DevoContext& context);

/// All changes of a life, in their order. Replacing one spring takes about 20 bytes, and scaling all springs by one
/// rule takes about 30 bytes. Causes are stored in single precision.
class LifeRecord {
 public:
  LifeRecord() = default;
  /// Restores a record from the bytes that bytes() returned. Throws std::invalid_argument if they are not a record.
  explicit LifeRecord(std::string bytes);

  void add(const Change& change);
  std::vector<Change> changes() const;

  bool empty() const { return bytes_.empty(); }
  const std::string& bytes() const { return bytes_; }

  friend bool operator==(const LifeRecord& a, const LifeRecord& b) { return a.bytes_ == b.bytes_; }

 private:
  std::string bytes_;
  MaterialNumbers materials_;  ///< materials written so far; later changes refer to them by number
};

/// Whether any edit has a cause.
bool has_causes(const Edits& edits);

/// What names the masses of a body throughout a life, while indices change.
///
/// - The number of a mass at birth is its index; masses that are added later get the next numbers.
/// - Its identity (DevoContext::identity()) is the same in all individuals that have inherited the mass.
class MassNumbers {
 public:
  /// Masses that have their indices for identities.
  explicit MassNumbers(std::size_t born);
  explicit MassNumbers(std::vector<std::uint64_t> identities);

  /// Adds the new masses of a change, which resolved() has returned, then removes its removed masses.
  void apply(const Edits& edits);
  /// Does one after the other: adds a mass after the others and returns its number; removes masses, given by their
  /// indices in ascending order.
  std::uint32_t add(const NewMass& mass);
  void remove(const std::vector<Removal>& masses);

  /// The numbers of all masses, in the order of their indices. This order is ascending.
  const std::vector<std::uint32_t>& numbers() const { return numbers_; }
  const std::vector<std::uint64_t>& identities() const { return identities_; }
  /// The number of daughters that each mass has had (NewMass::mother).
  const std::vector<std::uint32_t>& daughters() const { return daughters_; }

 private:
  std::vector<std::uint32_t> numbers_, daughters_;
  std::vector<std::uint64_t> identities_;
  std::uint32_t next_;
};

/// Gives each of the new masses of an edit its identity, unless it has one.
void derive_identities(std::vector<NewMass>& masses, const DevoContext& context);

}  // namespace evodevo
