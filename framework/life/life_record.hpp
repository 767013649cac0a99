// What development did to a body in the course of its life, compactly.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/materials.hpp"
#include "evodevo/devo.hpp"

namespace evodevo {

/// Edits that were made together after a cycle. All indices refer to the body as it was before these edits.
struct Change {
  std::uint32_t cycle = 0;          ///< from 1
  std::optional<std::uint32_t> op;  ///< index into the experiment's devo operators; none: of what was torn off
  Edits edits;                      ///< resolved()
  bool lengths_given = false;       ///< whether the operator itself gave a new spring its rest length
};

/// The change that `edits`, wanted by operator `op`, are about to make.
Change change_by(const Edits& edits, std::optional<std::uint32_t> op, const DevoContext& context);

/// All changes of a life, in their order: about 20 bytes for a spring that goes and one that comes, some 30 for an
/// application at which all springs grow. Causes are kept in single precision.
class LifeRecord {
 public:
  LifeRecord() = default;
  /// Restores a record from what bytes() returned. Throws std::invalid_argument if `bytes` is not such a record.
  explicit LifeRecord(std::string bytes);

  void add(const Change& change);
  std::vector<Change> changes() const;

  bool empty() const { return bytes_.empty(); }
  const std::string& bytes() const { return bytes_; }

  friend bool operator==(const LifeRecord& a, const LifeRecord& b) { return a.bytes_ == b.bytes_; }

 private:
  std::string bytes_;
  MaterialNumbers materials_;  ///< those written so far, to which others refer by their numbers
};

/// The numbers that masses keep through a life: those at birth their index, later ones the next numbers.
class MassNumbers {
 public:
  explicit MassNumbers(std::size_t born);

  /// The number of a new mass, which follows the others.
  std::uint32_t add();
  /// Lets masses go, by their indices in ascending order.
  void remove(const std::vector<std::uint32_t>& masses);
  /// All that a change does: its new masses come, then others go.
  void apply(const Edits& edits);

  /// By the masses' indices, ascending.
  const std::vector<std::uint32_t>& numbers() const { return numbers_; }

 private:
  std::vector<std::uint32_t> numbers_;
  std::uint32_t next_;
};

/// The numbers of a body's masses after the changes of its life.
std::vector<std::uint32_t> mass_numbers(std::size_t born, const LifeRecord& record);

}  // namespace evodevo
