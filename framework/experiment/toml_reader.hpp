// Reads declared parameters from TOML. Error messages give the place, the value and a remedy.
#pragma once

#include <toml++/toml.h>

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "evodevo/parameters.hpp"
#include "experiment/config_errors.hpp"

namespace evodevo {

/// Parses TOML text. `origin` is the name of the file in messages. Throws ConfigError with file:line:column if the text
/// is not valid TOML or exceeds the limits of toml_limits.hpp.
toml::table parse_toml(std::string_view text, const std::string& origin);

/// Reads and parses a file. Throws ConfigError like parse_toml(), and if the file cannot be read.
toml::table parse_toml_file(const std::string& file);

/// Returns "file:line:column" of a node or key. If a command-line option has set the value, returns the option; if an
/// argument of a function has set it, returns the function, such as "simulate()".
std::string location_of(const toml::source_region& source);

/// Returns a node's value as messages show it: `"text"`, `3`, `[1, 2]`, `a table`.
std::string value_text(const toml::node& node);

/// The contents of files that parameters name, by their paths as in the TOML file.
using FileContents = std::map<std::string, std::string>;

/// What values of a table may refer to.
struct References {
  const std::vector<std::string>* materials = nullptr;  ///< names of materials; null if the table may not name any
  /// Folder of relative paths. It is not used if `recorded_files` has the contents of all files.
  std::filesystem::path folder = {};
  const FileContents* recorded_files = nullptr;
  FileContents* files = nullptr;  ///< gets the contents of files that are read, if not null
};

/// Reads declared variables from a TOML table. If a key is absent or wrong, its variable keeps the default. If
/// errors are collected, reading goes on after an error; otherwise the first error is thrown. To report an error is to
/// collect it, or to throw it if errors are not collected.
class TomlReader final : public Parameters {
 public:
  /// `path` is the table's name in messages, such as "scene.floor"; empty for the top level. `errors` is the collector
  /// of errors, or null.
  TomlReader(const toml::table& table, std::string path, References references = {}, ErrorCollector* errors = nullptr)
      : table_(table), path_(std::move(path)), references_(std::move(references)), errors_(errors) {}

  void declare(const Parameter& parameter) override;
  void require(bool holds, std::string_view name, std::string_view text) override;

  using Parameters::text;
  /// Returns the string of a key, or `fallback` if the key is absent. Throws ConfigError if the key is absent and
  /// `fallback` is null.
  std::string text(std::string_view name, const char* fallback = nullptr);
  std::vector<std::string> texts(std::string_view name);
  std::vector<std::string> keys() const;
  /// Returns an empty table. Messages about it name the same file as messages about this table.
  toml::table empty_table() const;
  /// Returns the sub-table `name`; nullptr if it is absent.
  const toml::table* table(std::string_view name);
  /// Returns whether the table has a key, without reading it.
  bool has(std::string_view name) const { return table_.contains(name); }
  /// Returns the tables of the array `name`; empty if it is absent.
  std::vector<const toml::table*> tables(std::string_view name);

  /// Reports each key of the table that is not one of `names` and has not been read. To be called before the keys are
  /// read, so that a misspelt key is not reported as a missing one.
  void expect(std::initializer_list<std::string_view> names);

  /// Throws std::logic_error if a key that is not one of `names` has been read so far.
  void require_read_among(std::span<const std::string_view> names) const;

  /// Reports each key of the table that has not been read and, if the table has no other error, the conditions that do
  /// not hold.
  void finish() const;

  /// Calls `read`, and reports the KeyError that it may throw.
  template <class Read>
  void attempt(const Read& read) const {
    try {
      read();
    } catch (const KeyError& error) {
      if (errors_ == nullptr) throw;
      errors_->add(error);
    }
  }
  /// Throws the first error that has been collected in this table, if there is one.
  void stop_if_wrong() const;
  ErrorCollector* errors() const { return errors_; }

  /// Returns the place of key `name`, or the place of the table if the key is absent.
  std::string location(std::string_view name) const;
  /// Throws KeyError with the place of key `name`, or the place of the table if the key is absent. `depends_on` names
  /// the keys and tables that, if they are wrong themselves, may have caused the error.
  [[noreturn]] void fail(std::string_view name, const std::string& message,
                         std::vector<std::string> depends_on = {}) const;
  /// Like fail(), but returns if errors are collected.
  void report(std::string_view name, const std::string& message, std::vector<std::string> depends_on = {}) const;
  /// Returns the name of a key with its path, such as "scene.floor.stiffness".
  std::string full_name(std::string_view name) const;

 private:
  void set(std::string_view name, const parameter::Real& real);
  void set(std::string_view name, const parameter::Integer& integer);
  void set(std::string_view name, const parameter::Flag& flag);
  void set(std::string_view name, const parameter::Choice& choice);
  void set(std::string_view name, const parameter::Vector& vector);
  void set(std::string_view name, const parameter::VectorOrChoice& either);
  void set(std::string_view name, const parameter::Counts& counts);
  void set(std::string_view name, const parameter::OptionalReal& real);
  void set(std::string_view name, const parameter::Reals& reals);
  void set(std::string_view name, const parameter::Text& text);
  void set(std::string_view name, const parameter::File& file);
  void set(std::string_view name, const parameter::Materials& materials);

  const toml::node* look_up(std::string_view name);
  void know(std::string_view name);
  /// Calls `take` with the node of a key, if the table has it; collects an error that it throws.
  template <class Take>
  void read(std::string_view name, const Take& take);
  void report_unknown_keys() const;
  [[noreturn]] void refuse_unknown_key(const toml::key& key) const;
  double number(const toml::node& node, std::string_view name, Range range) const;
  /// Returns the value of an integer such as 3, or of a float without a fraction such as 3.0.
  std::int64_t whole_number(const toml::node& node, std::string_view name, Range range) const;
  /// Returns the file that key `name` names by its path.
  InputFile named_file(const std::string& path, std::string_view name) const;
  const toml::array& three(const toml::node& node, std::string_view name) const;
  [[noreturn]] void fail_at(const toml::node& node, std::string_view name, const std::string& message,
                            std::vector<std::string> depends_on = {}) const;

  const toml::table& table_;
  std::string path_;
  References references_;
  ErrorCollector* errors_;
  std::vector<std::string> known_;
  std::vector<KeyError> failed_conditions_;
};

}  // namespace evodevo
