// The interface between host and plugin: a plugin exports one function, which returns constant data.
#pragma once

#if __cplusplus < 202002L
#error "evodevo: plugins are compiled as C++20; build with evodevo_add_plugin(), or with -std=c++20"
#endif

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <version>

#include "evodevo/devo.hpp"
#include "evodevo/encoding.hpp"
#include "evodevo/fitness.hpp"
#include "evodevo/selection.hpp"
#include "evodevo/variation.hpp"

namespace evodevo {

inline constexpr std::uint64_t plugin_magic = 0x6f7665646f7665ull;  // "evodevo", little-endian
/// Version of the interface. It must be raised whenever a declaration that plugins see changes its meaning, or is
/// changed, moved, added or removed; tests/host/plugin_border_test.cpp finds changed declarations.
inline constexpr std::uint32_t plugin_epoch = 21;

/// Returns a hash of the sizes of structs.
template <class... Structs>
constexpr std::uint32_t digest_of_sizes() {
  std::uint32_t digest = 2166136261u;  // FNV-1a
  for (const std::size_t size : {sizeof(Structs)...}) digest = (digest ^ static_cast<std::uint32_t>(size)) * 16777619u;
  return digest;
}

/// A hash of the sizes of all structs that host and plugin exchange.
inline constexpr std::uint32_t plugin_struct_digest =
    digest_of_sizes<Body, Mass, Spring, Material, State, Rng, GeneSpec, BlockType, Block, Genome, Layout, Parents,
                    VariationContext, EncodingContext, Blueprint, DevoContext, Edits, NewMass, NewSpring, ChangedSpring,
                    RecordRequest, Measure, Request, Observation, Samples, StoredSample, BodyVersion, Objective,
                    Candidate, SelectionContext, SelectionMemory, Case, NoteTitle, Note, ChildNote, Couple, Survival,
                    Child, Offspring, Selection, Removal, Scaling, MemoryEdits, Traits, Parameter, InputFile, Range,
                    Box, Vec3>();

#define EVODEVO_TEXT_(x) #x
#define EVODEVO_TEXT(x) EVODEVO_TEXT_(x)

/// The binary interfaces (ABI) of the compiler and of the standard library.
inline constexpr const char* plugin_toolchain =
#if defined(__GLIBCXX__)
    "C++ ABI " EVODEVO_TEXT(__GXX_ABI_VERSION) ", libstdc++, std::string ABI " EVODEVO_TEXT(_GLIBCXX_USE_CXX11_ABI);
#elif defined(_LIBCPP_VERSION)
    "C++ ABI " EVODEVO_TEXT(__GXX_ABI_VERSION) ", libc++ ABI " EVODEVO_TEXT(_LIBCPP_ABI_VERSION);
#else
    "unknown";
#endif

/// Compiler switches that change the memory layout of types of the standard library.
inline constexpr const char* plugin_switches =
#if defined(_GLIBCXX_DEBUG)
    "_GLIBCXX_DEBUG";
#else
    "none";
#endif

/// One operator of a plugin.
struct OperatorEntry {
  const char* kind;       ///< "encoding", "mutation", "crossover", "devo", "fitness" or "selection"
  const char* name;       ///< name by which experiments refer to the operator
  const char* summary;    ///< one sentence that says what the operator does and which publication it comes from
  Operator* (*create)();  ///< returns a new instance of the operator
};

/// The description of a plugin. The members up to `switches` keep their order in every epoch. A host can therefore read
/// them from a plugin of any epoch, and refuse the plugin before it reads further.
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

/// Returns which functions of Selection the selection operator class `T` overrides.
template <class T>
constexpr Overrides overrides_of() {
  static_assert(
      std::is_convertible_v<decltype(&T::parents),
                            std::vector<Couple> (T::*)(const SelectionContext&, std::uint32_t, Rng&) const> &&
          std::is_convertible_v<decltype(&T::survivors),
                                Survival (T::*)(const SelectionContext&, std::uint32_t, Rng&) const> &&
          std::is_convertible_v<decltype(&T::children),
                                Offspring (T::*)(const SelectionContext&, std::uint32_t, Rng&) const>,
      "evodevo: the selection operator declares parents(), survivors() or children() otherwise than Selection; write "
      "override behind each function to see which one");
  constexpr Overrides found = {!std::is_same_v<decltype(&T::parents), decltype(&Selection::parents)>,
                               !std::is_same_v<decltype(&T::survivors), decltype(&Selection::survivors)>,
                               !std::is_same_v<decltype(&T::children), decltype(&Selection::children)>};
  static_assert(found.parents || found.survivors || found.children,
                "evodevo: the selection operator does nothing; override parents(), survivors() or children()");
  static_assert(!found.parents || !found.children,
                "evodevo: the selection operator overrides parents() and children(), of which only one is called; "
                "override parents() to choose couples, or children() to make the children itself");
  return found;
}

/// Returns a new operator of class `T`.
template <class T>
Operator* new_operator() {
  T* op = new T;
  if constexpr (std::is_base_of_v<Selection, T>) op->overrides = overrides_of<T>();
  return op;
}

/// Returns the entry of operator class `T`.
template <class T>
constexpr OperatorEntry operator_entry(const char* name, const char* summary) {
  static_assert(
      !varies_by_layout<T>,
      "evodevo: since ABI epoch 21, mutate() and cross() get a VariationContext in place of the Layout: write "
      "`const VariationContext& context` in place of `const Layout& layout`, and context.layout in the body");
  static_assert(varies_by_layout<T> || !std::is_abstract_v<T>,
                "evodevo: the operator lacks a function, or declares it otherwise than its kind; look for a missing "
                "const, and write override behind each function to see which one");
  if constexpr (std::is_abstract_v<T>)
    return {};
  else
    return {T::kind.data(), name, summary, new_operator<T>};
}

}  // namespace evodevo

/// Exports the operators of a library. The arguments after the licence are the operators, each as
/// operator_entry<Class>("name", "summary"). Use this macro once in each library.
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
