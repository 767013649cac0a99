// Libraries that the host must refuse, each with the one fault that FAULT names.
#include "evodevo/plugin.hpp"

namespace {

struct Nothing final : evodevo::Mutation {
  void mutate(evodevo::Genome&, const evodevo::Layout&, evodevo::Rng&) const override {}
};

constexpr evodevo::OperatorEntry entries[] = {
#if defined(FAULT_TAKEN_NAME)
    evodevo::operator_entry<Nothing>("reset-weight", "Has the name of another operator."),
#elif defined(FAULT_UNKNOWN_KIND)
    {"wing", "nothing", "Is of a kind that does not exist.", []() -> evodevo::Operator* { return new Nothing; }},
#else
    evodevo::operator_entry<Nothing>("nothing", "Changes nothing."),
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
    "1.0.0",
    "MIT",
    entries,
    1};

}  // namespace

#if defined(FAULT_NO_ENTRY)
extern "C" __attribute__((visibility("default"))) const void* other_function() { return &manifest; }
#else
extern "C" __attribute__((visibility("default"))) const evodevo::PluginManifest* evodevo_plugin() { return &manifest; }
#endif
