// Writes settings and parameters as TOML, including every default.
#pragma once

#include <toml++/toml.h>

#include "evodevo/parameters.hpp"

namespace evodevo {

/// The counterpart of TomlReader: given the same declarations, it makes a table from which TomlReader reads the same
/// values.
class TomlWriter final : public Parameters {
 public:
  void declare(const Parameter& parameter) override;
  void require(bool, std::string_view, std::string_view) override {}

  /// Adds a string, a list or a table that is not a declared parameter.
  template <class Value>
  void add(std::string_view name, Value&& value) {
    table_.insert_or_assign(name, std::forward<Value>(value));
  }

  toml::table take() { return std::move(table_); }

 private:
  template <class Variable>
  void write(std::string_view name, const Variable& variable);
  void write(std::string_view name, const parameter::Vector& vector);
  void write(std::string_view name, const parameter::VectorOrChoice& either);
  void write(std::string_view name, const parameter::Counts& counts);
  void write(std::string_view name, const parameter::OptionalReal& real);
  void write(std::string_view name, const parameter::Reals& reals);
  void write(std::string_view name, const parameter::File& file);
  void write(std::string_view name, const parameter::Materials& materials);

  toml::table table_;
};

}  // namespace evodevo
