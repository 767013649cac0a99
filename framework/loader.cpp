#include "loader.hpp"

#include <algorithm>
#include <boost/dll/runtime_symbol_info.hpp>
#include <boost/dll/shared_library.hpp>
#include <deque>
#include <stdexcept>

#include "text.hpp"

namespace evodevo {
namespace {

namespace fs = std::filesystem;

constexpr const char* entry_symbol = "evodevo_plugin";
constexpr std::string_view suffix = ".evodevo.so";

/// Opened libraries are never closed: objects and type information of theirs may live anywhere in the process.
std::deque<boost::dll::shared_library>& open_libraries() {
  static std::deque<boost::dll::shared_library> libraries;
  return libraries;
}

[[noreturn]] void refuse(const std::string& reason) { throw std::runtime_error(reason); }

[[noreturn]] void refuse_mismatch(const std::string& what, const std::string& theirs, const std::string& ours) {
  refuse(what + " is " + theirs + ", this evodevo's is " + ours +
         "; rebuild the plugin against this evodevo with the same compiler");
}

/// The loader's own sentence. Boost appends the description of an unrelated errno, which misleads.
std::string loader_sentence(const boost::dll::fs::system_error& error) {
  std::string text = error.what();
  const auto noise = text.rfind(": ");
  const auto first = text.find(": ");
  if (noise != std::string::npos && noise != first) text.erase(noise);
  return text;
}

boost::dll::shared_library open(const fs::path& file) {
  boost::dll::shared_library library;
  try {
    library.load(file, boost::dll::load_mode::rtld_now | boost::dll::load_mode::rtld_local);
  } catch (const boost::dll::fs::system_error& error) {
    refuse("cannot be loaded: " + loader_sentence(error));
  }
  return library;
}

using EntryFunction = const PluginManifest*();

const PluginManifest* read_manifest(const boost::dll::shared_library& library, const fs::path& file) {
  if (!library.has(entry_symbol)) {
    refuse(std::string("has no function ") + entry_symbol + "; end one of its sources with EVODEVO_PLUGIN(...)");
  }
  EntryFunction& entry = library.get<EntryFunction>(entry_symbol);
  // a library that merely links a plugin finds the plugin's entry as if it were its own
  const fs::path home = boost::dll::symbol_location_ptr(&entry);
  if (!fs::equivalent(home, file)) {
    refuse(std::string("has no function ") + entry_symbol + " of its own, only that of " + home.string() +
           " which it links; end one of its sources with EVODEVO_PLUGIN(...)");
  }
  return entry();
}

/// Refuses a manifest that this host may not read on. The order matters: each line vouches for the next.
void check_manifest(const PluginManifest* manifest) {
  if (manifest == nullptr || manifest->magic != plugin_magic) {
    refuse(std::string("its ") + entry_symbol + " does not return an evodevo manifest; use EVODEVO_PLUGIN(...)");
  }
  if (manifest->epoch != plugin_epoch)
    refuse_mismatch("its ABI epoch", std::to_string(manifest->epoch), std::to_string(plugin_epoch));
  if (manifest->manifest_size != sizeof(PluginManifest))
    refuse_mismatch("its manifest size", std::to_string(manifest->manifest_size),
                    std::to_string(sizeof(PluginManifest)));
  if (manifest->struct_digest != plugin_struct_digest)
    refuse_mismatch("its digest of struct sizes", std::to_string(manifest->struct_digest),
                    std::to_string(plugin_struct_digest));
  if (std::string_view(manifest->toolchain) != plugin_toolchain)
    refuse_mismatch("its toolchain", manifest->toolchain, plugin_toolchain);
  if (std::string_view(manifest->switches) != plugin_switches)
    refuse_mismatch("its list of build switches", manifest->switches, plugin_switches);
}

void check_entry(const OperatorEntry& entry) {
  if (std::find(operator_kinds.begin(), operator_kinds.end(), entry.kind) == operator_kinds.end())
    refuse(std::string("its operator \"") + entry.name + "\" is of the unknown kind \"" + entry.kind + "\"");
}

auto sort_key(const AvailableOperator& available) {
  return std::pair<std::string_view, std::string_view>(available.entry->kind, available.entry->name);
}

}  // namespace

Registry::Registry(const std::vector<fs::path>& folders) {
  for (const fs::path& folder : folders) load_folder(folder);
  std::sort(operators_.begin(), operators_.end(),
            [](const auto& a, const auto& b) { return sort_key(a) < sort_key(b); });
}

void Registry::load_folder(const fs::path& folder) {
  std::vector<fs::path> files;
  try {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
      if (entry.path().filename().string().ends_with(suffix)) files.push_back(entry.path());
  } catch (const fs::filesystem_error& error) {
    failed_.push_back({folder, "the folder cannot be read: " + error.code().message()});
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    try {
      load(fs::absolute(file));
    } catch (const std::exception& error) {
      failed_.push_back({file, error.what()});
    }
  }
}

void Registry::load(const fs::path& file) {
  boost::dll::shared_library library = open(file);
  const PluginManifest* manifest = read_manifest(library, file);
  check_manifest(manifest);
  const std::span<const OperatorEntry> entries(manifest->entries, manifest->entry_count);
  for (const OperatorEntry& entry : entries) {
    check_entry(entry);
    if (const AvailableOperator* twin = find(entry.kind, entry.name)) {
      refuse(std::string("its ") + entry.kind + " operator \"" + entry.name + "\" is already brought by " +
             twin->file.string() + "; rename one of them");
    }
  }
  for (const OperatorEntry& entry : entries) operators_.push_back({&entry, manifest, file});
  open_libraries().push_back(std::move(library));
}

const AvailableOperator* Registry::find(std::string_view kind, std::string_view name) const {
  const auto found = std::find_if(operators_.begin(), operators_.end(),
                                  [&](const auto& available) { return sort_key(available) == std::pair(kind, name); });
  return found == operators_.end() ? nullptr : &*found;
}

std::vector<std::string> Registry::names(std::string_view kind) const {
  std::vector<std::string> names;
  for (const AvailableOperator& available : operators_)
    if (available.entry->kind == kind) names.emplace_back(available.entry->name);
  return names;
}

fs::path builtin_plugin_folder() {
  const fs::path program = boost::dll::program_location();
  return program.parent_path().parent_path() / EVODEVO_PLUGIN_DIR;
}

}  // namespace evodevo
