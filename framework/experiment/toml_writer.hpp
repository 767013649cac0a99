// Writes settings and parameters as TOML, including every default.
#pragma once

#include <toml++/toml.h>

#include "experiment/settings_visitor.hpp"

namespace evodevo {

/// The counterpart of TomlReader: given the same declarations, it makes a table from which TomlReader reads the same
/// values.
class TomlWriter final : public SettingsVisitor {
 public:
  void real(double& value, std::string_view name, Range range, std::string_view text) override;
  void integer(std::int64_t& value, std::string_view name, Range range, std::string_view text) override;
  void flag(bool& value, std::string_view name, std::string_view text) override;
  void choice(std::string& value, std::string_view name, std::initializer_list<std::string_view> options,
              std::string_view text) override;
  void vector(Vec3& value, std::string_view name, Range range, std::string_view text) override;
  void vector_or_choice(Vec3& value, std::string& word, std::string_view name, Range range,
                        std::initializer_list<std::string_view> options, std::string_view text) override;
  void counts(std::array<std::int64_t, 3>& value, std::string_view name, Range range, std::string_view text) override;
  void optional_real(std::optional<double>& value, std::string_view name, Range range, std::string_view text) override;
  void reals(std::vector<double>& value, std::string_view name, Range range, std::string_view text) override;
  void text(std::string& value, std::string_view name, std::string_view text) override;
  void file(InputFile& value, std::string_view name, std::string_view text) override;
  void materials(std::vector<std::string>& value, std::string_view name, std::string_view text) override;
  void require(bool holds, std::string_view name, std::string_view text) override;
  void real_or_auto(std::optional<double>& value, std::string_view name, Range range, std::string_view text) override;

  /// Adds a string, a list or a table that is not a declared parameter.
  template <class Value>
  void add(std::string_view name, Value&& value) {
    table_.insert_or_assign(name, std::forward<Value>(value));
  }

  toml::table take() { return std::move(table_); }

 private:
  toml::table table_;
};

}  // namespace evodevo
