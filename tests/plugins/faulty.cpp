// Libraries with one fault each, which the macro FAULT names. The host must refuse the library, or stop when its
// operator fails.
#include <cfenv>
#include <csignal>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>

#include "evodevo/plugin.hpp"

void nobody_defines_this();

namespace {

constexpr std::string_view fault = FAULT;

[[maybe_unused]] const bool crash = fault == "crash" && std::raise(SIGSEGV) != 0;
[[maybe_unused]] const bool gone = fault == "exit" && (std::_Exit(3), true);
[[maybe_unused]] const bool thrown = fault == "static_throws" && (throw 7, true);  // NOLINT
[[maybe_unused]] const bool rounds = fault == "rounds" && std::fesetround(FE_UPWARD) == 0;

struct Nothing final : evodevo::Mutation {
  std::int64_t genes = fault == "default" ? 7 : 1;
  double every = 7;

  Nothing() {
    if constexpr (fault == "constructor") throw std::runtime_error("no licence");
    if constexpr (fault == "constructor_throws_a_number") throw 7;
  }
  void parameters([[maybe_unused]] evodevo::Parameters& p) override {
    if constexpr (fault == "default") p.integer(genes, "genes", {0, 5, "1"}, "Genes that change.");
    if constexpr (fault == "controls_in_parameter")
      p.integer(genes, "genes\x1b[31m", {0, 5, "\u009b"}, "Genes\nthat change.\xff");
    if constexpr (fault == "reserved") p.real(every, "every", {0, 50, "1"}, "Genes from one to the next.");
  }
  void mutate([[maybe_unused]] evodevo::Genome& genome, const evodevo::VariationContext&,
              evodevo::Rng&) const override {
    if constexpr (fault == "throws") throw std::runtime_error("nothing to mutate");
    if constexpr (fault == "controls_thrown")
      throw std::runtime_error("\x1b[31mnothing\nto mutate\xff" + std::string(1'000'000, '!'));
    if constexpr (fault == "crash_in_use") std::raise(SIGSEGV);
    if constexpr (fault == "reads_beyond") genome[0] = genome[genome.size()];
    if constexpr (fault == "nan") genome[0] = std::numeric_limits<float>::quiet_NaN();
    if constexpr (fault == "undefined_symbol") nobody_defines_this();
  }
};

struct Way final : evodevo::Fitness {
  evodevo::Request observes() const override { return {0, 0.1, false}; }
  std::vector<evodevo::Objective> objectives() const override { return {{"way\x1b[31m", "m", true}}; }
  std::vector<double> score(const evodevo::Observation&) const override { return {0}; }
};

constexpr evodevo::OperatorEntry faulty_entry() {
  if (fault == "controls_in_objective") return evodevo::operator_entry<Way>("way", "Measures nothing.");
  evodevo::OperatorEntry entry = evodevo::operator_entry<Nothing>("nothing", "Changes nothing.");
  if (fault == "taken_name") entry.name = "reset-weight";
  if (fault == "controls_in_name") entry.name = "noth\x1b[31ming";
  if (fault == "null_name") entry.name = nullptr;
  if (fault == "empty_name") entry.name = "";
  if (fault == "controls_in_summary") entry.summary = "Changes\nnothing.";
  if (fault == "null_summary") entry.summary = nullptr;
  if (fault == "unknown_kind") entry.kind = "wing";
  if (fault == "null_kind") entry.kind = nullptr;
  if (fault == "other_class") entry.kind = "devo";
  if (fault == "null_create") entry.create = nullptr;
  if (fault == "creates_null") entry.create = []() -> evodevo::Operator* { return nullptr; };
  return entry;
}

constexpr evodevo::OperatorEntry entries[] = {faulty_entry(), faulty_entry()};

constexpr evodevo::PluginManifest faulty_manifest() {
  evodevo::PluginManifest manifest = {
      evodevo::plugin_magic,         evodevo::plugin_epoch,     sizeof(evodevo::PluginManifest),
      evodevo::plugin_struct_digest, evodevo::plugin_toolchain, evodevo::plugin_switches,
      EVODEVO_PLUGIN_VERSION,        EVODEVO_PLUGIN_LICENSE,    entries,
      fault == "twin" ? 2u : 1u};
  if (fault == "magic") manifest.magic = 1;
  if (fault == "epoch") manifest.epoch = 99;
  if (fault == "manifest_size") manifest.manifest_size = 8;
  if (fault == "structs") manifest.struct_digest = 5;
  if (fault == "toolchain") manifest.toolchain = "another compiler";
  if (fault == "null_toolchain") manifest.toolchain = nullptr;
  if (fault == "switches") manifest.switches = "-fpacked";
  if (fault == "controls_in_version") manifest.version = "1.0\x07";
  if (fault == "null_version") manifest.version = nullptr;
  if (fault == "controls_in_licence") manifest.license = "MIT\x07";
  if (fault == "empty_licence") manifest.license = "";
  if (fault == "null_entries") manifest.entries = nullptr;
  return manifest;
}

constexpr evodevo::PluginManifest manifest = faulty_manifest();

}  // namespace

extern "C" __attribute__((visibility("default"))) const evodevo::PluginManifest* evodevo_plugin() { return &manifest; }
