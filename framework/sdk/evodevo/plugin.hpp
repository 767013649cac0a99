// The border between host and plugin: one exported function that returns constant data.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <version>

#include "evodevo/devo.hpp"
#include "evodevo/encoding.hpp"
#include "evodevo/fitness.hpp"
#include "evodevo/selection.hpp"
#include "evodevo/variation.hpp"

namespace evodevo {

inline constexpr std::uint64_t plugin_magic = 0x6f7665646f7665ull;  // "evodevo", little-endian
/// Raised whenever anything that crosses the border changes its meaning; tests/host/plugin_border_test.cpp sees to it.
inline constexpr std::uint32_t plugin_epoch = 6;

/// A digest of the sizes of everything that crosses the border.
inline constexpr std::uint32_t plugin_struct_digest = [] {
  std::uint32_t digest = 2166136261u;  // FNV-1a
  for (const std::size_t size :
       {sizeof(Body),          sizeof(Mass),     sizeof(Spring),  sizeof(Material),        sizeof(State),
        sizeof(Rng),           sizeof(GeneSpec), sizeof(Layout),  sizeof(EncodingContext), sizeof(Blueprint),
        sizeof(DevoContext),   sizeof(Edits),    sizeof(NewMass), sizeof(NewSpring),       sizeof(ChangedSpring),
        sizeof(SpringRequest), sizeof(Measure),  sizeof(Request), sizeof(Observation),     sizeof(Objective),
        sizeof(Candidate),     sizeof(Size),     sizeof(Growth)})
    digest = (digest ^ static_cast<std::uint32_t>(size)) * 16777619u;
  return digest;
}();

#define EVODEVO_TEXT_(x) #x
#define EVODEVO_TEXT(x) EVODEVO_TEXT_(x)

/// Compiler and standard library, as far as their binary interfaces may differ.
inline constexpr const char* plugin_toolchain =
#if defined(__GLIBCXX__)
    "C++ ABI " EVODEVO_TEXT(__GXX_ABI_VERSION) ", libstdc++, std::string ABI " EVODEVO_TEXT(_GLIBCXX_USE_CXX11_ABI);
#elif defined(_LIBCPP_VERSION)
    "C++ ABI " EVODEVO_TEXT(__GXX_ABI_VERSION) ", libc++ ABI " EVODEVO_TEXT(_LIBCPP_ABI_VERSION);
#else
    "unknown";
#endif

/// Build switches that change the layout of standard types.
inline constexpr const char* plugin_switches =
#if defined(_GLIBCXX_DEBUG)
    "_GLIBCXX_DEBUG";
#else
    "none";
#endif

/// One operator that a plugin brings.
struct OperatorEntry {
  const char* kind;     ///< "encoding", "mutation", "crossover", "devo", "fitness" or "selection"
  const char* name;     ///< as TOML files write it
  const char* summary;  ///< one sentence, with its source
  Operator* (*create)();
};

/// What a plugin says of itself. The members up to `switches` keep their order in every epoch, so that a host can
/// refuse a plugin of another one before it reads further.
struct PluginManifest {
  std::uint64_t magic;
  std::uint32_t epoch;
  std::uint32_t manifest_size;
  std::uint32_t struct_digest;
  const char* toolchain;
  const char* switches;
  const char* version;
  const char* license;
  const OperatorEntry* entries;
  std::size_t entry_count;
};

/// The table row of operator class `T`.
template <class T>
constexpr OperatorEntry operator_entry(const char* name, const char* summary) {
  return {T::kind.data(), name, summary, []() -> Operator* { return new T; }};
}

}  // namespace evodevo

/// Exports the operators that follow, each as operator_entry<Class>("name", "sentence"). Once per library.
#define EVODEVO_PLUGIN(version, license, ...)                                                         \
  extern "C" __attribute__((visibility("default"))) const evodevo::PluginManifest* evodevo_plugin() { \
    static constexpr evodevo::OperatorEntry entries[] = {__VA_ARGS__};                                \
    static constexpr evodevo::PluginManifest manifest = {evodevo::plugin_magic,                       \
                                                         evodevo::plugin_epoch,                       \
                                                         sizeof(evodevo::PluginManifest),             \
                                                         evodevo::plugin_struct_digest,               \
                                                         evodevo::plugin_toolchain,                   \
                                                         evodevo::plugin_switches,                    \
                                                         version,                                     \
                                                         license,                                     \
                                                         entries,                                     \
                                                         sizeof(entries) / sizeof(entries[0])};       \
    return &manifest;                                                                                 \
  }
