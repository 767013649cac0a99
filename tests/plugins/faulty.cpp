// Libraries with one fault each, which FAULT names: the host must refuse them, or stop where their operator errs.
#include <csignal>
#include <cstdlib>
#include <limits>
#include <stdexcept>

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
#elif defined(FAULT_CONSTRUCTOR)
  Nothing() { throw std::runtime_error("no licence"); }
#endif

  void mutate([[maybe_unused]] evodevo::Genome& genome, const evodevo::Layout&, evodevo::Rng&) const override {
#if defined(FAULT_THROWS)
    throw std::runtime_error("nothing to mutate");
#elif defined(FAULT_CRASH_IN_USE)
    std::raise(SIGSEGV);
#elif defined(FAULT_NAN)
    genome[0] = std::numeric_limits<float>::quiet_NaN();
#elif defined(FAULT_UNDEFINED_SYMBOL)
    nobody_defines_this();
#endif
  }
};

constexpr evodevo::OperatorEntry entries[] = {
#if defined(FAULT_TAKEN_NAME)
    evodevo::operator_entry<Nothing>("reset-weight", "Has the name of another operator."),
#elif defined(FAULT_UNKNOWN_KIND)
    {"wing", "nothing", "Is of a kind that does not exist.", []() -> evodevo::Operator* { return new Nothing; }},
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
    EVODEVO_PLUGIN_VERSION,
    EVODEVO_PLUGIN_LICENSE,
    entries,
    std::size(entries)};

}  // namespace

#if defined(FAULT_NO_ENTRY)
extern "C" __attribute__((visibility("default"))) const void* other_function() { return &manifest; }
#else
extern "C" __attribute__((visibility("default"))) const evodevo::PluginManifest* evodevo_plugin() { return &manifest; }
#endif
