// Parameters, declared once beside what they steer: the host reads them from TOML, checks, describes and records them.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <limits>
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

/// A visitor of parameters. An operator hands it every parameter once: the variable, whose value is the default, its
/// name, what is allowed, and one sentence. The host's visitors fill the variables or write down what is declared.
class Parameters {
 public:
  virtual void real(double& value, std::string_view name, Range range, std::string_view text) = 0;
  virtual void integer(std::int64_t& value, std::string_view name, Range range, std::string_view text) = 0;
  virtual void flag(bool& value, std::string_view name, std::string_view text) = 0;
  virtual void choice(std::string& value, std::string_view name, std::initializer_list<std::string_view> options,
                      std::string_view text) = 0;
  /// Three numbers, each in the range.
  virtual void vector(Vec3& value, std::string_view name, Range range, std::string_view text) = 0;
  /// Three whole numbers, each in the range.
  virtual void counts(std::array<std::int64_t, 3>& value, std::string_view name, Range range,
                      std::string_view text) = 0;
  /// Names of the experiment's materials; an empty list stands for all of them.
  virtual void materials(std::vector<std::string>& value, std::string_view name, std::string_view text) = 0;
  /// What has to hold between parameters handed over before. `name` is the one to blame, `text` says what is expected.
  virtual void require(bool holds, std::string_view name, std::string_view text) = 0;

 protected:
  ~Parameters() = default;
};

}  // namespace evodevo
