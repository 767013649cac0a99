#include "operators/surroundings.hpp"

#include <cfenv>
#include <cstring>
#include <locale>
#include <vector>

#include "base/text.hpp"

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace evodevo {
namespace {

#if defined(__x86_64__)
constexpr std::uint32_t flags = 0x003f;  // exception flags in MXCSR, which the program does not use
constexpr std::uint32_t rounding = 0x6000, flushing = 0x8040;

std::uint32_t arithmetic_control() { return _mm_getcsr() & ~flags; }
void set_arithmetic_control(std::uint32_t control) {
  // these two also concern long double, which has a unit of its own
  std::fesetround(static_cast<int>((control & rounding) >> 3));
  fedisableexcept(FE_ALL_EXCEPT);
  _mm_setcsr((_mm_getcsr() & flags) | control);
}
#else
constexpr std::uint32_t rounding = ~0u, flushing = 0;

std::uint32_t arithmetic_control() { return static_cast<std::uint32_t>(std::fegetround()); }
void set_arithmetic_control(std::uint32_t control) { std::fesetround(static_cast<int>(control)); }
#endif

/// The locale when the program started. The program itself never changes it.
struct Locale {
  std::string c = std::setlocale(LC_ALL, nullptr);
  std::locale cpp;
};

const Locale& own_locale() {
  static const Locale locale;
  return locale;
}

}  // namespace

Surroundings::Surroundings() : arithmetic_control_(arithmetic_control()), thread_locale_(uselocale(nullptr)) {
  own_locale();
}

bool Surroundings::same_arithmetic() const { return arithmetic_control() == arithmetic_control_; }

bool Surroundings::same_locale() const {
  const Locale& own = own_locale();
  return uselocale(nullptr) == thread_locale_ && std::strcmp(std::setlocale(LC_ALL, nullptr), own.c.c_str()) == 0 &&
         std::locale() == own.cpp;
}

std::string Surroundings::put_back() const {
  std::vector<std::string> changed;
  const std::uint32_t control = arithmetic_control() ^ arithmetic_control_;
  if ((control & rounding) != 0) changed.emplace_back("the rounding mode");
  if ((control & flushing) != 0) changed.emplace_back("flush-to-zero");
  if ((control & ~(rounding | flushing)) != 0) changed.emplace_back("the traps of floating point");
  if (!same_arithmetic()) set_arithmetic_control(arithmetic_control_);
  if (!same_locale()) {
    changed.emplace_back("the locale");
    uselocale(thread_locale_);
    std::locale::global(own_locale().cpp);
    std::setlocale(LC_ALL, own_locale().c.c_str());
  }
  return joined(changed, " and ");
}

}  // namespace evodevo
