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

/// All changes of a life, in their order. Replacing one spring takes about 20 bytes, and letting all springs grow once
/// takes about 30 bytes. Causes are stored in single precision.
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

/// Numbers of masses that stay the same throughout a life, while indices change. The number of a mass at birth is its
/// index; masses that are added later get the next numbers.
class MassNumbers {
 public:
  explicit MassNumbers(std::size_t born);

  /// Adds a mass after the others and returns its number.
  std::uint32_t add();
  /// Removes masses, given by their indices in ascending order.
  void remove(const std::vector<std::uint32_t>& masses);
  /// Adds the new masses of a change, then removes its removed masses.
  void apply(const Edits& edits);

  /// The numbers of all masses, in the order of their indices. This order is ascending.
  const std::vector<std::uint32_t>& numbers() const { return numbers_; }

 private:
  std::vector<std::uint32_t> numbers_;
  std::uint32_t next_;
};

}  // namespace evodevo
