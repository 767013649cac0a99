// The interface through which operators declare their parameters. An operator declares each parameter once; from the
// declarations, the host reads parameters from TOML, checks them, describes them and records them.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
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

/// The types of values of parameters. Each refers to the variable that holds the value.
namespace parameter {

using Options = std::span<const std::string_view>;  ///< names; they need not outlive the declaration

struct Real {
  double& value;
  Range range;
};

struct Integer {
  std::int64_t& value;
  Range range;
};

struct Flag {
  bool& value;
};

struct Choice {
  std::string& value;  ///< one of the options
  Options options;
};

struct Vector {
  Vec3& value;
  Range range;  ///< of each number
};

struct VectorOrChoice {
  Vec3& value;
  std::string& word;  ///< one of the options; empty if the value is a vector
  Range range;        ///< of each number
  Options options;
};

struct Counts {
  std::array<std::int64_t, 3>& value;
  Range range;  ///< of each number
};

struct OptionalReal {
  std::optional<double>& value;
  Range range;
  std::string_view none;  ///< the word that stands for no value; empty: there is none if the parameter is left out
};

struct Reals {
  std::vector<double>& value;
  Range range;  ///< of each number
};

struct Text {
  std::string& value;
};

struct File {
  InputFile& value;
};

struct Materials {
  std::vector<std::string>& value;
};

using Variable = std::variant<Real, Integer, Flag, Choice, Vector, VectorOrChoice, Counts, OptionalReal, Reals, Text,
                              File, Materials>;

}  // namespace parameter

/// A declared parameter. The initial value of its variable is the default.
struct Parameter {
  std::string_view name;
  std::string_view text;  ///< one sentence that explains the parameter
  parameter::Variable variable;
};

/// What an operator declares its parameters to: one call for each, with the variable that holds the parameter, the
/// name, the allowed values, and one sentence that explains it. The host may set the variable within the call, so that
/// what follows may depend on it.
class Parameters {
 public:
  void real(double& value, std::string_view name, Range range, std::string_view text) {
    declare({name, text, parameter::Real{value, range}});
  }
  void integer(std::int64_t& value, std::string_view name, Range range, std::string_view text) {
    declare({name, text, parameter::Integer{value, range}});
  }
  void flag(bool& value, std::string_view name, std::string_view text) {
    declare({name, text, parameter::Flag{value}});
  }
  void choice(std::string& value, std::string_view name, std::initializer_list<std::string_view> options,
              std::string_view text) {
    declare({name, text, parameter::Choice{value, options}});
  }
  /// A vector of three real numbers, each within the range.
  void vector(Vec3& value, std::string_view name, Range range, std::string_view text) {
    declare({name, text, parameter::Vector{value, range}});
  }
  /// A vector of three real numbers, each within the range, or one of the words; `word` is empty if it is a vector.
  void vector_or_choice(Vec3& value, std::string& word, std::string_view name, Range range,
                        std::initializer_list<std::string_view> options, std::string_view text) {
    declare({name, text, parameter::VectorOrChoice{value, word, range, options}});
  }
  /// A vector of three whole numbers, each within the range.
  void counts(std::array<std::int64_t, 3>& value, std::string_view name, Range range, std::string_view text) {
    declare({name, text, parameter::Counts{value, range}});
  }
  /// A real number that may be left out, so that it has no value.
  void optional_real(std::optional<double>& value, std::string_view name, Range range, std::string_view text) {
    declare({name, text, parameter::OptionalReal{value, range, ""}});
  }
  /// A list of real numbers, each within the range.
  void reals(std::vector<double>& value, std::string_view name, Range range, std::string_view text) {
    declare({name, text, parameter::Reals{value, range}});
  }
  /// A text of at most 10,000 bytes.
  void text(std::string& value, std::string_view name, std::string_view text) {
    declare({name, text, parameter::Text{value}});
  }
  /// A file of at most 64 MiB.
  void file(InputFile& value, std::string_view name, std::string_view text) {
    declare({name, text, parameter::File{value}});
  }
  /// A list of names of the experiment's materials; an empty list stands for all of them.
  void materials(std::vector<std::string>& value, std::string_view name, std::string_view text) {
    declare({name, text, parameter::Materials{value}});
  }

  /// What the functions above call.
  virtual void declare(const Parameter& parameter) = 0;
  /// A condition on parameters that were declared before. If it does not hold, the host reports an error in parameter
  /// `name` with `text`, which should say what is expected. Default values must fulfil all conditions, except those on
  /// a text or a file that is empty by default: such a condition makes the parameter a required one.
  virtual void require(bool holds, std::string_view name, std::string_view text) = 0;

 protected:
  ~Parameters() = default;
};

}  // namespace evodevo
