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

// x86 has two floating-point units, SSE and x87. Each has a control register, and reading both takes about 1 ns.
#if defined(__x86_64__)
constexpr std::uint32_t flags = 0x003f;  // exception flags in MXCSR, which the program does not use
constexpr std::uint32_t rounding = 0x6000, flushing = 0x8040, rounding_x87 = 0x0c00;

std::uint32_t vector_control() { return _mm_getcsr() & ~flags; }
std::uint32_t scalar_control() {
  std::uint16_t word;
  __asm__ volatile("fnstcw %0" : "=m"(word));
  return word;
}
void set_controls(std::uint32_t vector, std::uint32_t scalar) {
  _mm_setcsr((_mm_getcsr() & flags) | vector);
  const auto word = static_cast<std::uint16_t>(scalar);
  __asm__ volatile("fldcw %0" : : "m"(word));
}
#else
constexpr std::uint32_t rounding = ~0u, flushing = 0, rounding_x87 = 0;

std::uint32_t vector_control() { return static_cast<std::uint32_t>(std::fegetround()); }
std::uint32_t scalar_control() { return 0; }
void set_controls(std::uint32_t vector, std::uint32_t) { std::fesetround(static_cast<int>(vector)); }
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

Surroundings::Surroundings()
    : vector_control_(vector_control()), scalar_control_(scalar_control()), thread_locale_(uselocale(nullptr)) {
  own_locale();
}

bool Surroundings::same_arithmetic() const {
  return vector_control() == vector_control_ && scalar_control() == scalar_control_;
}

bool Surroundings::same_locale() const {
  const Locale& own = own_locale();
  return uselocale(nullptr) == thread_locale_ && std::strcmp(std::setlocale(LC_ALL, nullptr), own.c.c_str()) == 0 &&
         std::locale() == own.cpp;
}

std::string Surroundings::put_back() const {
  std::vector<std::string> changed;
  const std::uint32_t vector = vector_control() ^ vector_control_, scalar = scalar_control() ^ scalar_control_;
  if ((vector & rounding) != 0 || (scalar & rounding_x87) != 0) changed.emplace_back("the rounding mode");
  if ((vector & flushing) != 0) changed.emplace_back("flush-to-zero");
  if ((vector & ~(rounding | flushing)) != 0 || (scalar & ~rounding_x87) != 0)
    changed.emplace_back("the traps or the precision of floating point");
  if (!same_arithmetic()) set_controls(vector_control_, scalar_control_);
  if (!same_locale()) {
    changed.emplace_back("the locale");
    uselocale(thread_locale_);
    std::locale::global(own_locale().cpp);
    std::setlocale(LC_ALL, own_locale().c.c_str());
  }
  return joined(changed, " and ");
}

}  // namespace evodevo
