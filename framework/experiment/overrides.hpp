// Overrides: values of keys that are given on the command line instead of in the file of an experiment.
#pragma once

#include <toml++/toml.h>

#include <string>

namespace evodevo {

/// One key of an experiment and its new value.
struct Override {
  std::string key;     ///< "table.key"; an item of a list is given by its index from 0, as in "fitness.0.window"
  std::string value;   ///< TOML; anything that is not valid TOML is taken as a string
  std::string origin;  ///< place to show in messages instead of file, line and column, such as "--seed 7"
};

/// Sets one key. Creates missing tables that contain it. An index equal to the length of a list appends an item; any
/// other item must exist. Throws ConfigError if the key cannot be set, or if the key or the value exceeds the limits of
/// toml_limits.hpp.
void apply_override(const Override& change, toml::table& root);

}  // namespace evodevo
