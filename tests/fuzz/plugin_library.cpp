// A library of operators whose manifest comes from the target that loads it.
#include "fuzz/plugin_library.hpp"

extern "C" __attribute__((visibility("default"))) const evodevo::PluginManifest* evodevo_plugin() {
  return fuzzed_manifest();
}
