// The interface of visitors of settings and parameters, such as the reader that fills them from TOML and the writer
// that writes them as TOML.
#pragma once

#include <optional>
#include <string_view>

#include "evodevo/parameters.hpp"

namespace evodevo {

class SettingsVisitor : public Parameters {
 public:
  /// A number or the word "auto". If it is "auto", `value` is empty.
  virtual void real_or_auto(std::optional<double>& value, std::string_view name, Range range,
                            std::string_view text) = 0;

 protected:
  ~SettingsVisitor() = default;
};

}  // namespace evodevo
