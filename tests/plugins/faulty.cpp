// Libraries with one fault each, which FAULT names: the host must refuse them, or stop where their operator errs.
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
#endif

  void mutate([[maybe_unused]] evodevo::Genome& genome, const evodevo::Layout&, evodevo::Rng&) const override {
#if defined(FAULT_THROWS)
    throw std::runtime_error("nothing to mutate");
#elif defined(FAULT_CONTROLS_THROWN)
    throw std::runtime_error("\x1b[31mnothing\nto mutate\xff" + std::string(1'000'000, '!'));
#elif defined(FAULT_CRASH_IN_USE)
    std::raise(SIGSEGV);
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
#else
    EVODEVO_PLUGIN_VERSION,
#endif
    EVODEVO_PLUGIN_LICENSE,
    entries,
    std::size(entries)};

}  // namespace

#if defined(FAULT_NO_ENTRY)
extern "C" __attribute__((visibility("default"))) const void* other_function() { return &manifest; }
#else
extern "C" __attribute__((visibility("default"))) const evodevo::PluginManifest* evodevo_plugin() { return &manifest; }
#endif
