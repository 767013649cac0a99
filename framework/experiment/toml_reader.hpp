// Reads declared parameters from TOML, with errors that name place, value and remedy.
#pragma once

#include <toml++/toml.h>

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/input_error.hpp"
#include "experiment/settings_visitor.hpp"

namespace evodevo {

/// Parses TOML text. `origin` stands for the file in messages. Throws ConfigError with file:line:column, also where it
/// goes beyond the limits of toml_limits.hpp.
toml::table parse_toml(std::string_view text, const std::string& origin);

/// Reads and parses a file. Throws ConfigError where it cannot be read.
toml::table parse_toml_file(const std::string& file);

/// "file:line:column" of a node or key; of what an option has set, the option.
std::string location_of(const toml::source_region& source);

/// A node's value as a message shows it: `"text"`, `3`, `[1, 2]`, `a table`.
std::string value_text(const toml::node& node);

/// The visitor that fills variables from a table. Keys that are absent leave the default.
class TomlReader final : public SettingsVisitor {
 public:
  /// `path` is the table's name in messages, such as "scene.floor"; empty for the top level. `materials` are the
  /// material names that may be referred to; nullptr where none may.
  TomlReader(const toml::table& table, std::string path, const std::vector<std::string>* materials = nullptr)
      : table_(table), path_(std::move(path)), materials_(materials) {}

  void real(double& value, std::string_view name, Range range, std::string_view text) override;
  void integer(std::int64_t& value, std::string_view name, Range range, std::string_view text) override;
  void flag(bool& value, std::string_view name, std::string_view text) override;
  void choice(std::string& value, std::string_view name, std::initializer_list<std::string_view> options,
              std::string_view text) override;
  void vector(Vec3& value, std::string_view name, Range range, std::string_view text) override;
  void counts(std::array<std::int64_t, 3>& value, std::string_view name, Range range, std::string_view text) override;
  void materials(std::vector<std::string>& value, std::string_view name, std::string_view text) override;
  void require(bool holds, std::string_view name, std::string_view text) override;
  void real_or_auto(std::optional<double>& value, std::string_view name, Range range, std::string_view text) override;

  /// A text; where `fallback` is null the key must be there.
  std::string text(std::string_view name, const char* fallback = nullptr);
  std::vector<std::string> texts(std::string_view name);
  std::vector<std::string> keys() const;
  /// An empty table that is where this one is, for messages.
  toml::table empty_table() const;
  /// The sub-table `name`, or nullptr.
  const toml::table* table(std::string_view name);
  /// The tables of the array `name`; none where it is absent.
  std::vector<const toml::table*> tables(std::string_view name);

  /// Refuses every other key before any of these is read, so that a misspelt key is not reported as a missing one.
  void expect(std::initializer_list<std::string_view> names);

  /// Throws std::logic_error if a key other than these has been read so far.
  void require_read_among(std::span<const std::string_view> names) const;

  /// Throws ConfigError if the table holds a key that nothing asked for.
  void finish() const;

  /// Where key `name` is, or the table where the key is absent.
  std::string location(std::string_view name) const;
  /// Throws ConfigError that points at key `name`, or at the table where the key is absent.
  [[noreturn]] void fail(std::string_view name, const std::string& message) const;
  /// "scene.floor.stiffness".
  std::string full_name(std::string_view name) const;

 private:
  const toml::node* look_up(std::string_view name);
  void know(std::string_view name);
  void refuse_unknown_keys() const;
  double number(const toml::node& node, std::string_view name, Range range) const;
  /// Of 3 and of 3.0.
  std::int64_t whole_number(const toml::node& node, std::string_view name, Range range) const;
  const toml::array& three(const toml::node& node, std::string_view name) const;
  [[noreturn]] void fail_at(const toml::node& node, std::string_view name, const std::string& message) const;

  const toml::table& table_;
  std::string path_;
  const std::vector<std::string>* materials_;
  std::vector<std::string> known_;
};

}  // namespace evodevo
