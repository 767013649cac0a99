// The border between the target `plugin` and the library that it loads.
#pragma once

#include "evodevo/plugin.hpp"

/// Returns the manifest that the present input describes; defined in the target.
extern "C" __attribute__((visibility("default"))) const evodevo::PluginManifest* fuzzed_manifest();
