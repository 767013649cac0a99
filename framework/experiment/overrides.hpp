// Keys of an experiment that are set from outside its file.
#pragma once

#include <toml++/toml.h>

#include <string>

namespace evodevo {

/// One key of an experiment, set from outside.
struct Override {
  std::string key;     ///< "table.key"; items of lists by their number from 0, as in "fitness.0.window"
  std::string value;   ///< as TOML; what is not TOML is taken as a text
  std::string origin;  ///< stands for file, line and column in messages, such as "--seed 7"
};

/// Sets one key. Creates missing tables on the way, and the item after the last one of a list; any other item of a list
/// must exist. Throws ConfigError, for what goes beyond the limits of toml_limits.hpp too.
void apply_override(const Override& change, toml::table& root);

}  // namespace evodevo
