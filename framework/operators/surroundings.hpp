// Settings on which the whole program relies and which the code of any library can change: the settings of
// floating-point arithmetic and the locale.
#pragma once

#include <clocale>
#include <cstdint>
#include <string>

namespace evodevo {

/// The settings at the time when the object was made: this thread's rounding mode, flush-to-zero mode and
/// floating-point traps, and the locale.
class Surroundings {
 public:
  Surroundings();

  /// Restores the settings that have changed since then. Returns their names, such as "the rounding mode", or an empty
  /// text if none has changed.
  std::string restore() const {
    if (same_arithmetic() && same_locale()) [[likely]]
      return {};
    return put_back();
  }

 private:
  bool same_arithmetic() const;
  bool same_locale() const;
  std::string put_back() const;

  std::uint32_t arithmetic_control_;
  locale_t thread_locale_;
};

}  // namespace evodevo
