// What every part of the program relies on, and a library could change for all of them.
#pragma once

#include <clocale>
#include <cstdint>
#include <string>

namespace evodevo {

/// How this thread rounds and traps, and the locale, as they were when the object was made.
class Surroundings {
 public:
  Surroundings();

  /// Puts back what has changed since and says what it was, such as "the rounding mode"; empty where nothing has.
  std::string restore() const {
    if (same_arithmetic() && same_locale()) [[likely]]
      return {};
    return put_back();
  }

 private:
  bool same_arithmetic() const;
  bool same_locale() const;
  std::string put_back() const;

  std::uint32_t vector_control_, scalar_control_;
  locale_t thread_locale_;
};

}  // namespace evodevo
