// The interface through which operators declare their parameters. An operator declares each parameter once; from the
// declarations, the host reads parameters from TOML, checks them, describes them and records them.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "evodevo/body.hpp"

namespace evodevo {

/// The allowed values of a number, both ends included, and its unit ("1" for a pure number).
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  std::string_view unit = "1";
};

/// A file that a parameter names. The host reads it once and keeps its content with the run, so that the run can be
/// moved and resumed.
struct InputFile {
  std::string path;     ///< as in the TOML file: relative to the folder of the experiment; empty if none is named
  std::string content;  ///< all bytes of the file
};

/// A visitor of parameters. For every parameter, an operator calls one of these functions with the variable that holds
/// the parameter (its initial value is the default), the name, the allowed values, and one sentence that explains the
/// parameter. The host implements visitors, for example one that sets the variables and one that lists the parameters.
class Parameters {
 public:
  virtual void real(double& value, std::string_view name, Range range, std::string_view text) = 0;
  virtual void integer(std::int64_t& value, std::string_view name, Range range, std::string_view text) = 0;
  virtual void flag(bool& value, std::string_view name, std::string_view text) = 0;
  virtual void choice(std::string& value, std::string_view name, std::initializer_list<std::string_view> options,
                      std::string_view text) = 0;
  /// A vector of three real numbers, each within the range.
  virtual void vector(Vec3& value, std::string_view name, Range range, std::string_view text) = 0;
  /// A vector of three real numbers, each within the range, or one of the words; `word` is empty if it is a vector.
  virtual void vector_or_choice(Vec3& value, std::string& word, std::string_view name, Range range,
                                std::initializer_list<std::string_view> options, std::string_view text) = 0;
  /// A vector of three whole numbers, each within the range.
  virtual void counts(std::array<std::int64_t, 3>& value, std::string_view name, Range range,
                      std::string_view text) = 0;
  /// A real number that may be left out, so that it has no value.
  virtual void optional_real(std::optional<double>& value, std::string_view name, Range range,
                             std::string_view text) = 0;
  /// A list of real numbers, each within the range.
  virtual void reals(std::vector<double>& value, std::string_view name, Range range, std::string_view text) = 0;
  /// A text of at most 10,000 bytes.
  virtual void text(std::string& value, std::string_view name, std::string_view text) = 0;
  /// A file of at most 64 MiB.
  virtual void file(InputFile& value, std::string_view name, std::string_view text) = 0;
  /// A list of names of the experiment's materials; an empty list stands for all of them.
  virtual void materials(std::vector<std::string>& value, std::string_view name, std::string_view text) = 0;
  /// A condition on parameters that were declared before. If it does not hold, the host reports an error in parameter
  /// `name` with `text`, which should say what is expected. Default values must fulfil all conditions, except those on
  /// a text or a file that is empty by default: such a condition makes the parameter a required one.
  virtual void require(bool holds, std::string_view name, std::string_view text) = 0;

 protected:
  ~Parameters() = default;
};

}  // namespace evodevo
