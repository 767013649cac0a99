// Errors in the keys of an experiment, which are collected so that all of them can be reported at once.
#pragma once

#include <toml++/toml.h>

#include <string>
#include <string_view>
#include <vector>

#include "base/input_error.hpp"

namespace evodevo {

/// An error in one key, or in one table.
struct KeyError : ConfigError {
  KeyError(const std::string& message, std::string full_name, const toml::source_position& at,
           std::vector<std::string> others)
      : ConfigError(message), key(std::move(full_name)), position(at), depends_on(std::move(others)) {}

  std::string key;                      ///< full name, such as "scene.floor.stiffness"
  toml::source_position position;       ///< line and column; 0 for a value that a command-line option has set
  std::vector<std::string> depends_on;  ///< full names of keys and tables; if one is wrong, this may be no error
};

/// All errors of an experiment, in the order of its file. what() is the first one.
struct ConfigErrors : ConfigError {
  ConfigErrors(std::vector<ConfigError> errors, bool complete)
      : ConfigError(errors.front()), all(std::move(errors)), is_complete(complete) {}

  std::vector<ConfigError> all;
  bool is_complete;  ///< whether the whole experiment has been read
};

/// Collects the errors that readers find in an experiment.
class ErrorCollector {
 public:
  static constexpr std::size_t most = 100;  ///< number of errors after which reading ends

  /// Adds an error, unless there already is one with the same message, because some tables are read twice. Throws
  /// ConfigErrors if there are `most` of them.
  void add(const KeyError& error);
  /// Throws the first error in the key or table `name`, or in a table that contains it, if there is one.
  void throw_error_in(std::string_view name) const;
  /// Throws ConfigErrors with all errors that were added; does nothing if there are none. Leaves out those that depend
  /// on a key or table with another error, which may have caused them.
  void throw_errors() const;

 private:
  bool may_be_caused(std::size_t index) const;

  std::vector<KeyError> errors_;
};

}  // namespace evodevo
