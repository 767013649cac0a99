// A visitor of settings and parameters: a reader that fills them from TOML, or a writer that makes TOML of them.
#pragma once

#include <optional>
#include <string_view>

#include "evodevo/parameters.hpp"

namespace evodevo {

class SettingsVisitor : public Parameters {
 public:
  /// A number, or the word "auto", which stands for none.
  virtual void real_or_auto(std::optional<double>& value, std::string_view name, Range range,
                            std::string_view text) = 0;

 protected:
  ~SettingsVisitor() = default;
};

}  // namespace evodevo
