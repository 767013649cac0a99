// Operators of all kinds but crossover that load, but misbehave in the way that the parameter `how` names.
#include <unistd.h>

#include <atomic>
#include <cfenv>
#include <chrono>
#include <clocale>
#include <csignal>
#include <cstdlib>
#include <limits>
#include <locale>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <utility>

#include "evodevo/plugin.hpp"

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace {

volatile bool endless = true;

/// Overflows the stack; written so that the compiler cannot turn the recursion into a loop.
int deeper(int depth) {
  volatile char room[4096] = {};
  room[0] = static_cast<char>(depth);
  return endless ? deeper(depth + 1) + room[0] : depth;
}

/// Prints a line for which tests wait, and never returns.
[[noreturn]] void hang() {
  constexpr std::string_view text = "it hangs\n";
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text.data(), text.size());
  for (;;) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

/// A locale that is freed when the library is unloaded.
struct OtherLocale {
  OtherLocale() = default;
  OtherLocale(const OtherLocale&) = delete;
  OtherLocale& operator=(const OtherLocale&) = delete;
  ~OtherLocale() { freelocale(handle); }

  const locale_t handle = newlocale(LC_ALL_MASK, "C.UTF-8", nullptr);
};

/// Crashes when it is destroyed, if it was told to.
struct AtEnd {
  ~AtEnd() {
    if (crashes) std::raise(SIGSEGV);
  }

  std::atomic<bool> crashes = false;  // several threads call an operator
};

/// An operator of a kind that is told what to do.
template <class Kind>
struct Told : Kind {
  std::string how = "well";
  mutable AtEnd at_end;

  void parameters(evodevo::Parameters& p) override { p.text(how, "how", "What it does."); }
};

struct Mutation final : Told<evodevo::Mutation> {
  void mutate(evodevo::Genome&, const evodevo::VariationContext&, evodevo::Rng&) const override {
    at_end.crashes = how == "crash-at-end";
    if (how == "hang") hang();
    if (how == "exit") std::exit(0);
    if (how == "overflow") deeper(0);
    if (how == "round") std::fesetround(FE_UPWARD);
#if defined(__SSE__)
    if (how == "flush") _mm_setcsr(_mm_getcsr() | 0x8040);
#endif
    if (how == "locale") std::setlocale(LC_ALL, "C.UTF-8");
    static const OtherLocale other;
    if (how == "thread-locale") uselocale(other.handle);
    if (how == "global-locale") std::locale::global(std::locale("C.UTF-8"));
  }
};

struct Encoding final : Told<evodevo::Encoding> {
  evodevo::Layout layout(const evodevo::EncodingContext&) const override {
    if (how == "crash-in-layout") std::raise(SIGSEGV);
    if (how == "throw-in-layout") throw 7;
    evodevo::Layout layout;
    layout.add_block(2, {0, 1});
    return layout;
  }
  evodevo::Blueprint decode(const evodevo::Genome&, const evodevo::Layout&,
                            const evodevo::EncodingContext& context) const override {
    if (how == "crash") std::raise(SIGSEGV);
    at_end.crashes = how == "crash-at-end";
    evodevo::Blueprint blueprint;
    blueprint.body.materials = context.materials;
    blueprint.body.masses = {{{0, 0, 0}, 0.2}, {{0.7, 0, 0}, 0.2}, {{0, 0.7, 0}, 0.2}};
    blueprint.body.springs = {{0, 1, 0.7, 1}, {1, 2, 0.99, 1}, {2, 0, 0.7, 1}};
    if (how == "twin") blueprint.body.springs.push_back({1, 2, 0.99, 1});
    return blueprint;
  }
};

struct Devo final : Told<evodevo::Devo> {
  evodevo::RecordRequest observes() const override {
    if (how == "crash-when-asked") std::raise(SIGSEGV);
    if (how == "throw-when-asked") throw 7;
    return {};
  }
  void develop(const evodevo::DevoContext& context, evodevo::Edits&, evodevo::Rng&) const override {
    at_end.crashes = how == "crash-at-end";
    if (how == "crash" && context.cycle == 2) std::raise(SIGSEGV);
    if (how == "exit") std::exit(3);
    if (how == "overflow" && context.cycle == 2) deeper(0);
  }
};

struct Fitness final : Told<evodevo::Fitness> {
  evodevo::Request observes() const override {
    if (how == "no-window") return {0, 0, false};
    if (how == "endless-window") return {0, std::numeric_limits<double>::infinity(), false};
    if (how == "early-window") return {-0.1, 0.1, false};
    if (how == "window-that-is-no-number") return {std::numeric_limits<double>::quiet_NaN(), 0.1, false};
    if (how == "samples-without-end") return {.window = 0.1, .rate = 1.1e7};
    if (how == "samples-below-0") return {.window = 0.1, .rate = -1};
    if (how == "channels-without-samples") return {.window = 0.1, .channels = {.centre = true}};
    if (how == "before-birth") return {.window = 0.1, .cycle = -1};
    if (how == "after-the-last-cycle") return {.window = 0.1, .cycle = 1000};
    if (how == "beyond-the-life") return {.settle = 1, .window = 1e4, .cycle = 0};
    return {0, 0.1, false};
  }
  std::vector<evodevo::Objective> objectives() const override {
    using evodevo::Role;
    if (how == "no-objective") return {};
    if (how == "descriptor-without-cells") return {{"one", "1", true, Role::descriptor, 0, 1, 0}};
    if (how == "descriptor-with-too-many-cells") return {{"one", "1", true, Role::descriptor, 0, 1, 1001}};
    if (how == "unknown-role") return {{"one", "1", true, static_cast<Role>(99)}};
    if (how == "twin-scores") return {{"one", "1", true}, {"one", "m", true}};
    if (how == "empty-descriptor") return {{"one", "1", true, Role::descriptor, 1, 1}};
    return {{how == "nameless-objective" ? "" : "one", "1", true}};
  }
  std::vector<double> score(const evodevo::Observation&) const override {
    at_end.crashes = how == "crash-at-end";
    return std::vector<double>(how == "one-score-too-many" ? 2 : 1, 1.0);
  }
};

struct Selection final : Told<evodevo::Selection> {
  std::vector<evodevo::NoteTitle> notes() const override {
    if (how == "nameless-note") return {{"age"}, {""}};
    if (how == "twin-notes") return {{"age"}, {"size"}, {"age"}};
    return {};
  }
  std::vector<std::string> memory() const override {
    if (how == "nameless-list") return {"age", ""};
    if (how == "twin-lists") return {"age", "size", "age"};
    return {};
  }
  std::vector<evodevo::Couple> parents(const evodevo::SelectionContext& context, std::uint32_t count,
                                       evodevo::Rng& rng) const override {
    if (how == "no-parents") return evodevo::Selection::parents(context, count, rng);
    return std::vector<evodevo::Couple>(how == "too-few-parents" ? count - 1 : count);
  }
  evodevo::Survival survivors(const evodevo::SelectionContext& context, std::uint32_t population,
                              evodevo::Rng& rng) const override {
    if (how == "no-survivors") return evodevo::Selection::survivors(context, population, rng);
    return std::vector<std::uint32_t>{0};
  }
};

}  // namespace

EVODEVO_PLUGIN(EVODEVO_PLUGIN_VERSION, EVODEVO_PLUGIN_LICENSE,
               evodevo::operator_entry<Mutation>("misbehaves", "Does what it is told."),
               evodevo::operator_entry<Encoding>("misbehaves", "Does what it is told."),
               evodevo::operator_entry<Devo>("misbehaves", "Does what it is told."),
               evodevo::operator_entry<Fitness>("misbehaves", "Does what it is told."),
               evodevo::operator_entry<Selection>("misbehaves", "Does what it is told."))
