// Libraries with one fault each, which a macro FAULT_... selects. The host must refuse the library, or stop when its
// operator fails.
#include <cfenv>
#include <csignal>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string>

#include "evodevo/plugin.hpp"

#if defined(FAULT_UNDEFINED_SYMBOL)
void nobody_defines_this();
#endif

namespace {

#if defined(FAULT_CRASH)
[[maybe_unused]] const int crash = std::raise(SIGSEGV);
#elif defined(FAULT_EXIT)
[[maybe_unused]] const bool gone = (std::_Exit(3), true);
#elif defined(FAULT_STATIC_THROWS)
[[maybe_unused]] const bool thrown = (throw 7, true);  // NOLINT
#elif defined(FAULT_ROUNDS)
[[maybe_unused]] const bool rounds = (std::fesetround(FE_UPWARD), true);
#endif

struct Nothing final : evodevo::Mutation {
#if defined(FAULT_DEFAULT)
  std::int64_t genes = 7;
  void parameters(evodevo::Parameters& p) override { p.integer(genes, "genes", {0, 5, "1"}, "Genes that change."); }
#elif defined(FAULT_CONTROLS_IN_PARAMETER)
  std::int64_t genes = 1;
  void parameters(evodevo::Parameters& p) override {
    p.integer(genes, "genes\x1b[31m", {0, 5, "\u009b"}, "Genes\nthat change.\xff");
  }
#elif defined(FAULT_CONSTRUCTOR)
  Nothing() { throw std::runtime_error("no licence"); }
#elif defined(FAULT_CONSTRUCTOR_THROWS_A_NUMBER)
  Nothing() { throw 7; }
#elif defined(FAULT_RESERVED)
  double every = 7;
  void parameters(evodevo::Parameters& p) override {
    p.real(every, "every", {0, 50, "1"}, "Genes from one to the next.");
  }
#endif

  void mutate([[maybe_unused]] evodevo::Genome& genome, const evodevo::Layout&, evodevo::Rng&) const override {
#if defined(FAULT_THROWS)
    throw std::runtime_error("nothing to mutate");
#elif defined(FAULT_CONTROLS_THROWN)
    throw std::runtime_error("\x1b[31mnothing\nto mutate\xff" + std::string(1'000'000, '!'));
#elif defined(FAULT_CRASH_IN_USE)
    std::raise(SIGSEGV);
#elif defined(FAULT_READS_BEYOND)
    genome[0] = genome[genome.size()];
#elif defined(FAULT_NAN)
    genome[0] = std::numeric_limits<float>::quiet_NaN();
#elif defined(FAULT_UNDEFINED_SYMBOL)
    nobody_defines_this();
#endif
  }
};

#if defined(FAULT_CONTROLS_IN_OBJECTIVE)
struct Way final : evodevo::Fitness {
  evodevo::Request observes() const override { return {0, 0.1, false}; }
  std::vector<evodevo::Objective> objectives() const override { return {{"way\x1b[31m", "m", true}}; }
  std::vector<double> score(const evodevo::Observation&) const override { return {0}; }
};
#endif

constexpr evodevo::OperatorEntry entries[] = {
#if defined(FAULT_TAKEN_NAME)
    evodevo::operator_entry<Nothing>("reset-weight", "Has the name of another operator."),
#elif defined(FAULT_UNKNOWN_KIND)
    {"wing", "nothing", "Is of a kind that does not exist.", []() -> evodevo::Operator* { return new Nothing; }},
#elif defined(FAULT_CONTROLS_IN_NAME)
    evodevo::operator_entry<Nothing>("noth\x1b[31ming", "Changes nothing."),
#elif defined(FAULT_CONTROLS_IN_SUMMARY)
    evodevo::operator_entry<Nothing>("nothing", "Changes\nnothing."),
#elif defined(FAULT_CONTROLS_IN_OBJECTIVE)
    evodevo::operator_entry<Way>("way", "Measures nothing."),
#elif defined(FAULT_NULL_KIND)
    {nullptr, "nothing", "Is of no kind.", []() -> evodevo::Operator* { return new Nothing; }},
#elif defined(FAULT_NULL_NAME)
    {"mutation", nullptr, "Has no name.", []() -> evodevo::Operator* { return new Nothing; }},
#elif defined(FAULT_EMPTY_NAME)
    evodevo::operator_entry<Nothing>("", "Has an empty name."),
#elif defined(FAULT_NULL_SUMMARY)
    evodevo::operator_entry<Nothing>("nothing", nullptr),
#elif defined(FAULT_NULL_CREATE)
    {"mutation", "nothing", "Has no function that creates it.", nullptr},
#elif defined(FAULT_CREATES_NULL)
    {"mutation", "nothing", "Is not created.", []() -> evodevo::Operator* { return nullptr; }},
#elif defined(FAULT_OTHER_CLASS)
    {"devo", "nothing", "Is a mutation.", []() -> evodevo::Operator* { return new Nothing; }},
#else
    evodevo::operator_entry<Nothing>("nothing", "Changes nothing."),
#if defined(FAULT_TWIN)
    evodevo::operator_entry<Nothing>("nothing", "Changes nothing either."),
#endif
#endif
};

constexpr evodevo::PluginManifest manifest = {
#if defined(FAULT_MAGIC)
    1,
#else
    evodevo::plugin_magic,
#endif
#if defined(FAULT_EPOCH)
    99,
#else
    evodevo::plugin_epoch,
#endif
#if defined(FAULT_MANIFEST_SIZE)
    8,
#else
    sizeof(evodevo::PluginManifest),
#endif
#if defined(FAULT_STRUCTS)
    5,
#else
    evodevo::plugin_struct_digest,
#endif
#if defined(FAULT_TOOLCHAIN)
    "another compiler",
#elif defined(FAULT_NULL_TOOLCHAIN)
    nullptr,
#else
    evodevo::plugin_toolchain,
#endif
#if defined(FAULT_SWITCHES)
    "-fpacked",
#else
    evodevo::plugin_switches,
#endif
#if defined(FAULT_CONTROLS_IN_VERSION)
    "1.0\x07",
#elif defined(FAULT_NULL_VERSION)
    nullptr,
#else
    EVODEVO_PLUGIN_VERSION,
#endif
#if defined(FAULT_CONTROLS_IN_LICENCE)
    "MIT\x07",
#elif defined(FAULT_EMPTY_LICENCE)
    "",
#else
    EVODEVO_PLUGIN_LICENSE,
#endif
#if defined(FAULT_NULL_ENTRIES)
    nullptr,
#else
    entries,
#endif
    std::size(entries)};

}  // namespace

#if defined(FAULT_NO_ENTRY)
extern "C" __attribute__((visibility("default"))) const void* other_function() { return &manifest; }
#else
extern "C" __attribute__((visibility("default"))) const evodevo::PluginManifest* evodevo_plugin() { return &manifest; }
#endif
